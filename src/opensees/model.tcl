# The commands of an OpenSees model, for the safe interpreter "m" that runs its script: every proc of x is one there.
# Whatever is not read is refused with its line, whether the script catches it or not. What is read is printed at the end,
# in N, m and kg, for scene/opensees.c. Given: path (as the user wrote it), file and folder (without links), length and
# force (the units), initial (1: what yields is taken by its initial stiffness), level (src/opensees/main.c).

namespace eval x {}

# What has a tag, in the units of the model: node {x z}, fixed and mass {x z rot}, element (printed words),
# uniaxialMaterial E, section and beamIntegration {EA EI GA}, geomTransf {offsets of i and j}; follows(NODE,DOF).
foreach list {nodes elements arms notes refused command said shown} {set $list {}}
foreach flag {dims wiped analysed ended failed deep} {set $flag 0}
set dofs 3
set commands_max 1000000

# Part of Tcl's library, which is not needed for anything else; models use them too.
set functions {
    proc tcl::mathfunc::max {x args} {foreach y $args {if {$y > $x} {set x $y}}; return $x}
    proc tcl::mathfunc::min {x args} {foreach y $args {if {$y < $x} {set x $y}}; return $x}
}
eval $functions

# ---- words ------------------------------------------------------------------------------------------------------

proc numbers args {
    foreach x $args {
        if {![string is double -strict $x] || !(abs($x) < 1e300)} {error "'[string range $x 0 59]' is no number"}
    }
    return $args
}

proc tag t {
    if {![string is integer -strict $t]} {error "'[string range $t 0 59]' is no tag, a whole number"}
    return [expr {$t + 0}]
}

proc have {what t} {
    if {![info exists ::${what}([set t [tag $t]])]} {error "there is no $what $t above"}
    return $t
}

proc new {what t} {
    if {[info exists ::${what}([set t [tag $t]])]} {error "$what $t is there twice"}
    return $t
}

proc note word {
    if {$word ni $::notes} {lappend ::notes $word}
}

# As many numbers as a node has unknowns, of the first words.
proc unknowns words {
    if {[llength $words] < $::dofs} {error "wants TAG [lrange {x y rot} 0 $::dofs-1]"}
    return [lrange [concat [numbers {*}[lrange $words 0 $::dofs-1]] 0 0] 0 2]
}

# ---- nodes and what they are given --------------------------------------------------------------------------------

proc x::model {type args} {
    array set given [list -ndm 0 -ndf {} {*}$args]
    set ::dims $given(-ndm)
    set ::dofs [expr {$given(-ndf) ne {} ? $given(-ndf) : $::dims == 1 ? 1 : 3}]
    if {"$::dims $::dofs" ni {"2 3" "2 2" "1 1"}} {error "only -ndm 2 -ndf 3 (or 2), and -ndm 1 -ndf 1 are read"}
}

proc x::node {tag args} {
    if {$::wiped} {error "the model above was wiped; keep one of the two"}
    if {!$::dims} {error "'model BasicBuilder -ndm 2 -ndf 3' must stand above"}
    set t [new node $tag]
    set at [numbers {*}[lrange $args 0 $::dims-1]]
    set args [lrange $args $::dims end]
    if {[llength $at] < $::dims || ($args ne {} && ([lindex $args 0] ne "-mass" || [llength $args] <= $::dofs))} {
        error "behind TAG [lrange {x y} 0 $::dims-1] only -mass [lrange {mx my mr} 0 $::dofs-1] is read"
    }
    set ::node($t) [expr {$::dims == 1 ? {0 0} : $at}]
    set ::fixed($t) [list 0 [expr {$::dofs == 1}] [expr {$::dofs < 3}]]
    set ::mass($t) {0 0 0}
    lappend ::nodes $t
    if {$args ne {}} {mass $t {*}[lrange $args 1 end]}
}

proc hold {t words} {
    set ::fixed($t) [lmap was $::fixed($t) now [unknowns $words] {expr {$was || $now}}]
}

proc x::fix {tag args} {hold [have node $tag] $args}

# COORDINATE x y rot [-tol t]
proc line {axis at words} {
    set tolerance [expr {[lindex $words end-1] eq "-tol" ? [lindex $words end] : 1e-10}]
    numbers $at $tolerance
    foreach t $::nodes {
        if {abs([lindex $::node($t) $axis] - $at) <= $tolerance} {hold $t $words}
    }
}

proc x::fixX {at args} {line 0 $at $args}
proc x::fixY {at args} {line 1 $at $args}

# A later mass of a node replaces the earlier one (OpenSees: Node::setMass); that of elements adds to it at the end.
proc x::mass {tag args} {
    set m [unknowns $args]
    foreach x $m {
        if {$x < 0} {error "a mass of $x; it must not be negative"}
    }
    set ::mass([have node $tag]) $m
}

proc root {t d} {
    while {[info exists ::follows($t,$d)]} {set t $::follows($t,$d)}
    return $t
}

proc tie {node same_as dofs} {
    foreach d $dofs {
        set a [root $node $d]
        set b [root $same_as $d]
        if {$a == $b} {error "node $node and node $same_as are one, or tied already: a circle of ties"}
        set ::follows($a,$d) $b
    }
}

proc x::equalDOF {same_as node args} {
    foreach d $args {
        if {$d ni {1 2 3}} {error "'[string range $d 0 59]' is no degree of freedom 1 to 3"}
    }
    tie [have node $node] [have node $same_as] $args
}

# bar: both nodes move alike and turn by themselves; beam: the second is the end of an arm.
proc x::rigidLink {type carrier node} {
    set ends [list [have node $node] [have node $carrier]]
    switch -- [string trimleft $type -] {
        bar - rod {tie {*}$ends {1 2}}
        beam {lappend ::arms $ends}
        default {error "'[string range $type 0 19]' is neither bar nor beam"}
    }
}

proc x::rigidDiaphragm {direction same_as args} {
    foreach node $args {tie [have node $node] [have node $same_as] 1}
}

# ---- materials and sections ---------------------------------------------------------------------------------------

# Where the initial stiffness stands behind the tag: at a place, as the ratio of two times a number, or in another
# material.
set elastic {Elastic 0 MinMax of Fatigue of InitStressMaterial of InitStrainMaterial of}
set yields {Steel01 1 Steel02 1 Hardening 0 ElasticPP 0 ENT 0 ReinforcingSteel 2 SelfCentering 0
    Concrete01 {0 1 2} Concrete02 {0 1 2} Concrete04 3 Hysteretic {0 1 1} Pinching4 {0 1 1} Bilin 0 IMKBilin 0
    IMKPinching 0 IMKPeakOriented 0 ModIMKPeakOriented 0 ModIMKPinching 0}

proc x::uniaxialMaterial {type tag args} {
    if {[dict exists $::elastic $type]} {
        set how [dict get $::elastic $type]
    } elseif {[dict exists $::yields $type] && $::initial} {
        set how [dict get $::yields $type]
        note $type
    } else {
        error " $type: only Elastic TAG E is read[expr {[dict exists $::yields $type] ?
            "; building.elastic = initial takes what yields by its initial stiffness" : {}}]"
    }
    lassign $how at by factor
    set E [expr {$at eq "of" ? $::uniaxialMaterial([have uniaxialMaterial [lindex $args 0]])
                             : [numbers [lindex $args $at]]}]
    if {$by ne {}} {set E [expr {$factor * $E / [numbers [lindex $args $by]]}]}
    if {$E <= 0} {error " $type: E is $E; it must be above 0"}
    set ::uniaxialMaterial([new uniaxialMaterial $tag]) $E
}

proc modulus tag {return $::uniaxialMaterial([have uniaxialMaterial $tag])}
proc section_of tag {return $::section([have section $tag])}

proc fibre {E area y} {
    set ::fibres [lmap sum $::fibres times [list 1 $y [expr {$y * $y}]] {expr {$sum + $E * $area * $times}}]
}

proc x::fiber {y z area material} {fibre [modulus $material] {*}[numbers $area $y]}

# layer straight MATERIAL n A y z y z
proc x::layer {shape material n area y1 z1 y2 z2} {
    if {$shape ne "straight"} {error "only straight MATERIAL n A y z y z is read"}
    numbers $n $area $y1 $y2
    for {set i 0} {$i < $n} {incr i} {
        fibre [modulus $material] $area [expr {$n > 1 ? $y1 + ($y2 - $y1) * $i / ($n - 1.0) : 0.5 * ($y1 + $y2)}]
    }
}

# patch rect MATERIAL n n y z y z, patch quad MATERIAL n n with four corners: fibres at the middles of the cells, whose
# areas are those of a bilinear map.
proc x::patch {shape material ni nk args} {
    lassign [numbers {*}$args] y0 z0 y1 z1 y2 z2 y3 z3
    if {[string match rect* $shape]} {
        lassign [list $y0 $z0 $y1 $z0 $y1 $z1 $y0 $z1] y0 z0 y1 z1 y2 z2 y3 z3
    } elseif {![string match quad* $shape]} {
        error "only rect MATERIAL n n y z y z and quad MATERIAL n n with four corners are read"
    }
    for {set i 0} {$i < $ni} {incr i} {
        for {set k 0} {$k < $nk} {incr k} {
            set a [expr {($i + 0.5) / $ni}]
            set b [expr {($k + 0.5) / $nk}]
            set area [expr {abs(((1 - $b) * ($y1 - $y0) + $b * ($y2 - $y3)) * ((1 - $a) * ($z3 - $z0) + $a * ($z2 - $z1)) -
                                ((1 - $b) * ($z1 - $z0) + $b * ($z2 - $z3)) * ((1 - $a) * ($y3 - $y0) + $a * ($y2 - $y1)))
                            / $ni / $nk}]
            fibre [modulus $material] $area \
                [expr {(1 - $b) * ((1 - $a) * $y0 + $a * $y1) + $b * ((1 - $a) * $y3 + $a * $y2)}]
        }
    }
}

proc x::section {type tag args} {
    set s {0 0 0}
    switch -- $type {
        Elastic {
            lassign [numbers {*}[lrange $args 0 4]] E A I G alpha
            if {$I eq {}} {error " Elastic: wants TAG E A I"}
            if {!($E > 0 && $A > 0 && $I > 0)} {error "area $A, inertia $I and E $E must be above 0"}
            set s [list [expr {$E * $A}] [expr {$E * $I}] [expr {$alpha ne {} ? $G * $A * $alpha : 0}]]
        }
        Aggregator - Uniaxial {
            if {[lindex $args end-1] eq "-section"} {
                set s [section_of [lindex $args end]]
                set args [lrange $args 0 end-2]
            }
            foreach {material part} $args {
                set at [lsearch {P Mz Vy} $part]
                if {$at < 0} {error " Aggregator: '[string range $part 0 19]' is none of P, Mz, Vy"}
                lset s $at [modulus $material]
            }
        }
        Fiber - fiberSec {
            set ::fibres {0 0 0}
            interp eval m [lindex $args end]
            lassign $::fibres EA ES EI
            set s [list $EA [expr {$EA > 0 ? $EI - $ES * $ES / $EA : 0}] 0]
        }
        default {error " $type: only Elastic TAG E A I, Aggregator and Fiber are read"}
    }
    if {[expr [join $s +]] <= 0} {error " $type: E A is 0, and so are E I and G A"}
    set ::section([new section $tag]) $s
}

# The section of an integration TYPE SECTION ..., whose sections must be of one stiffness.
proc integrate rule {
    set words [lassign $rule type]
    switch -glob -- $type {
        Hinge* {set tags [lmap {tag length} $words {set tag}]}
        UserDefined - FixedLocation {set tags [lrange $words 1 [lindex $words 0]]}
        default {set tags [lrange $words 0 0]}
    }
    set s [lsort -unique [lmap tag $tags {section_of $tag}]]
    if {[llength $s] != 1} {error "its sections differ along the element; only equal ones are read"}
    return [lindex $s 0]
}

proc x::beamIntegration {type tag args} {
    set ::beamIntegration([new beamIntegration $tag]) [integrate [list $type {*}$args]]
}

proc x::geomTransf {type tag args} {
    if {$type ni {Linear PDelta Corotational}} {
        error "only Linear, PDelta and Corotational TAG are read; building.p_delta decides between them"
    }
    if {$type eq "Corotational"} {note $type}
    if {$args ne {} && ([lindex $args 0] ne "-jntOffset" || [llength $args] != 5)} {
        error "behind $type TAG only -jntOffset dXi dYi dXj dYj is read"
    }
    set ::geomTransf([new geomTransf $tag]) [expr {$args eq {} ? {0 0 0 0} : [numbers {*}[lrange $args 1 4]]}]
}

# ---- elements -----------------------------------------------------------------------------------------------------

# Of element i to j: where it begins and ends, with its offsets.
proc span {i j offsets} {
    lassign [concat $::node($i) $::node($j)] x0 z0 x1 z1
    lassign $offsets a b c d
    return [list [expr {$x1 + $c - $x0 - $a}] [expr {$z1 + $d - $z0 - $b}]]
}

# zeroLength TAG i j -mat M ... -dir D ... [-orient x y z ...]; twoNodeLink the same, halfway between its nodes;
# zeroLengthSection TAG i j SECTION
proc spring {type i j words} {
    set k {0 0 0}
    set offsets {0 0 0 0}
    set axis {1 0}
    lassign [span $i $j $offsets] dx dz
    if {$type eq "twoNodeLink" && hypot($dx, $dz) > 0} {
        set axis [list $dx $dz]
        set offsets [list [expr {0.5 * $dx}] [expr {0.5 * $dz}] [expr {-0.5 * $dx}] [expr {-0.5 * $dz}]]
    }
    if {$type eq "zeroLengthSection"} {
        lassign [section_of [lindex $words 0]] EA EI GA
        set k [list $EA $GA $EI]
        set words [lrange $words 1 end]
    }
    set key {}
    foreach word $words {
        if {[regexp {^-[a-zA-Z]} $word]} {set key $word} else {lappend of($key) $word}
        if {$key ni {-mat -dir -orient -doRayleigh}} {error " $type: '[string range $word 0 59]' is not read"}
    }
    if {![info exists of(-mat)]} {set of(-mat) [set of(-dir) {}]}
    if {![info exists of(-dir)] || [llength $of(-mat)] != [llength $of(-dir)] || ($of(-mat) eq {} && $k eq {0 0 0})} {
        error " $type: wants TAG i j -mat MATERIAL ... -dir 1|2|3 ..."
    }
    foreach material $of(-mat) direction $of(-dir) {
        set d [lsearch {1 2 3 - - 6} $direction]
        if {$d < 0} {error "$direction is no direction 1, 2 or 3"}
        set d [expr {min($d, 2)}]
        lset k $d [expr {[lindex $k $d] + [modulus $material]}]
    }
    if {[info exists of(-orient)]} {set axis [numbers {*}[lrange $of(-orient) 0 1]]}
    set length [expr {hypot([lindex $axis 0], [lindex $axis 1])}]
    if {!($length > 0)} {error " $type: -orient has no direction in the plane"}
    return [dict create i $i j $j s {1 1 0} rho 0 mass 0 pins {0 0} offsets $offsets spring 1 k $k \
                axis [lmap c $axis {expr {$c / $length}}]]
}

# {EA EI GA} and the transformation of a beam or a bar, from the words behind its nodes.
proc member {type words} {
    set n [llength $words]
    switch -- $type,$n {
        elasticBeamColumn,4 {
            lassign [numbers {*}[lrange $words 0 2]] A E I
            if {!($E > 0 && $A > 0 && $I > 0)} {error "area $A, inertia $I and E $E must be above 0"}
            return [list [list [expr {$E * $A}] [expr {$E * $I}] 0] [lindex $words 3]]
        }
        elasticBeamColumn,2 {return [list [lreplace [section_of [lindex $words 0]] 2 2 0] [lindex $words 1]]}
        elasticTimoshenkoBeam,6 {
            lassign [numbers {*}[lrange $words 0 4]] E G A I shear
            return [list [list [expr {$E * $A}] [expr {$E * $I}] [expr {$G * $shear}]] [lindex $words 5]]
        }
        truss,2 - corotTruss,2 {return [list [list [expr {[numbers [lindex $words 0]] * [modulus [lindex $words 1]]}] 1 0]]}
        truss,1 - corotTruss,1 {return [list [section_of $words]]}
    }
    if {$n > 1 && $type in {forceBeamColumn nonlinearBeamColumn dispBeamColumn}} {
        if {$n == 3 && [string is integer -strict [lindex $words 1]]} {
            set s [section_of [lindex $words 1]]
            set transformation [lindex $words 2]
        } else {
            set transformation [lindex $words 0]
            set rule [concat {*}[lrange $words 1 end]]
            set s [expr {[llength $rule] == 1 ? $::beamIntegration([have beamIntegration $rule]) : [integrate $rule]}]
        }
        if {$type eq "dispBeamColumn"} {lset s 2 0} ;# it does not deform in shear
        return [list $s $transformation]
    }
    error " $type: read are elasticBeamColumn TAG i j A E I TRANSF (or SECTION TRANSF), truss TAG i j A MATERIAL,\
        forceBeamColumn and dispBeamColumn TAG i j POINTS SECTION TRANSF (or TRANSF INTEGRATION),\
        ElasticTimoshenkoBeam, zeroLength, twoNodeLink"
}

proc x::element {type tag i j args} {
    set type [string tolower $type 0 0]
    set i [have node $i]
    set j [have node $j]
    set t [new element $tag]
    if {$type in {zeroLength zeroLengthSection twoNodeLink}} {
        set ::element($t) [spring $type $i $j $args]
        lappend ::elements $t
        return
    }
    set at [lsearch -regexp $args {^-[a-zA-Z]}]
    set options [expr {$at < 0 ? {} : [lrange $args $at end]}]
    lassign [member $type [expr {$at < 0 ? $args : [lrange $args 0 $at-1]}]] s transformation
    set offsets [expr {$transformation eq {} ? {0 0 0 0} : $::geomTransf([have geomTransf $transformation])}]
    set is_bar [string match *russ $type]
    set rho 0
    set release [expr {$is_bar ? 3 : 0}]
    set consistent 0
    while {$options ne {}} {
        set options [lassign $options key]
        switch -- $key {
            -mass - -rho {set options [lassign $options rho]}
            -release {set options [lassign $options release]}
            -cMass {set consistent 1}
            -lMass {set consistent 0}
            -iter {set options [lrange $options 2 end]}
            -integration {set options [lrange $options 1 end]}
            default {
                if {[string match -* $key]} {error " $type: '[string range $key 0 59]' is not read"}
                note $key
            }
        }
    }
    if {[numbers $rho] < 0} {error "a mass of $rho; it must not be negative"}
    if {$release ni {0 1 2 3}} {error "-release $release is none of 0 (none), 1 (end i), 2 (end j), 3 (both)"}
    lassign [span $i $j $offsets] dx dz
    set l [expr {hypot($dx, $dz)}]
    if {!($l > 0)} {error "element $t has no length: nodes $i and $j are at one place"}
    if {!([lindex $s 0] > 0 && [lindex $s 1] > 0)} {error "E A is [lindex $s 0] and E I [lindex $s 1]; both must be above 0"}
    set ::element($t) [dict create i $i j $j s $s rho [expr {$consistent ? $rho : 0}] \
        mass [expr {$consistent ? 0 : $rho * $l}] pins [list [expr {$release & 1}] [expr {$release >> 1}]] \
        offsets $offsets spring 0 k {0 0 0} axis {1 0}]
    lappend ::elements $t
}

# ---- around the model ---------------------------------------------------------------------------------------------

# Loads, damping, analysis, output, display: no part of the structure.
set skipped {algorithm analysis analyze constraints database defaultUnits display eigen eleLoad eleResponse fconfigure fill fixZ flush
    getTime groundMotion imposedMotion initialize integrator load loadConst logFile modalDamping modalProperties nodeAccel
    nodeBounds nodeDisp nodeEigenvector nodeReaction nodeVel numberer parameter pattern plane port print printA projection prp puts
    rayleigh reactions record recorder region remove reset save setPrecision setTime sp start stop system test timeSeries viewWindow
    vpn vrp vup wipeAnalysis}

# puts is none worth a word. A result of an analysis is 0; eigen has as many eigenvalues of 1 as it was asked for. What
# holds a node or takes a part of the structure away again is no output.
proc skip {name words} {
    if {$name eq "sp" || ($name eq "pattern" && [regexp {(^|[\s;])sp\s} [lindex $words end]])} {
        error "sp holds a displacement of a node; write fix where it is held for good"
    }
    if {$name eq "remove" && [lindex $words 0] in {element ele node sp sp_constraint mp spConstraint mpConstraint}} {
        error "remove [lindex $words 0] takes away a part of the structure; leave that part out instead"
    }
    if {$name ne "puts"} {note $name}
    if {$name in {eigen analyze}} {set ::analysed 1}
    if {$name eq "nodeBounds"} {return {-1 -1 -1 1 1 1}}
    if {$name ne "eigen"} {return 0}
    set n [lindex $words end]
    return [expr {[string is integer -strict $n] && $n > 0 && $n <= 1000 ? [lrepeat $n 1] : {}}]
}

proc x::nodeCoord {tag {direction {}}} {
    set xz $::node([have node $tag])
    return [expr {$direction eq {} ? $xz : [lindex $xz [string map {X 1 Y 2} $direction]-1]}]
}

proc x::wipe args {set ::wiped [expr {$::nodes ne {}}]}
proc x::exit args {
    set ::ended 1
    error exit
}
proc x::unknown {name args} {
    set ::command {}
    error "'[string range $name 0 59]' is not among the commands that are read (docs/building.md)"
}

# A file or folder that is the model's or below it: a model may come from anywhere. A device or a pipe is none.
proc below name {
    set whole [file normalize $name/..]/[file tail $name]
    for {set links 0} {[file exists $whole] && [file type $whole] eq "link" && $links < 20} {incr links} {
        set whole [file normalize [file join [file dirname $whole] [file readlink $whole]]]
    }
    set whole [file normalize $whole]
    return [expr {($whole eq $::folder || [string match [string map {* \\* ? \\? \[ \\\[ \\ \\\\} $::folder]/* $whole])
                  && [file exists $whole] && [file type $whole] in {file directory} ? $whole : {}}]
}

proc inside name {
    if {[set whole [below $name]] ne {}} {return $whole}
    error "[string range $name 0 199][expr {[file exists $name] ? { is not below the folder of the model} :
        {: there is no such file}}]"
}

proc x::source args {run [inside [lindex $args end]]}
proc x::cd {{name .}} {::cd [inside $name]}
proc x::pwd {} {::pwd}

# For reading; what is written goes nowhere.
proc x::open {name {mode r} args} {
    if {[string index $mode 0] in {w a}} {return [interp invokehidden m open /dev/null w]}
    return [interp invokehidden m open [inside $name] r]
}

proc x::file {what args} {
    switch -- $what {
        dirname - tail - extension - rootname - join - split - pathtype - nativename - normalize {return [::file $what {*}$args]}
        exists - isfile - isdirectory - readable {
            set whole [below [lindex $args 0]]
            return [expr {$whole ne {} && [::file $what $whole]}]
        }
        mkdir - delete - copy - rename {return}
        default {error "$what is not among what is read of it"}
    }
}

# ---- the script ---------------------------------------------------------------------------------------------------

# FILE:LINE of the command under way.
proc where {} {
    if {![catch {interp eval m {info frame -1}} frame] && [dict exists $frame file]} {
        set file [dict get $frame file]
        set ::shown [expr {$file eq $::file ? $::path : $file}]:[dict get $frame line]
    }
    return $::shown
}

proc refuse text {
    if {$::refused eq {}} {set ::refused $text}
}

proc take {name args} {
    set ::command $name
    if {[catch {
        if {[info procs ::x::$name] eq {}} {skip $name $args} else {x::$name {*}$args}
    } result]} {
        if {!$::ended && !$::failed && !($::analysed && $name in {open cd file source})} {
            regsub {^wrong # args: should be "x::\S+ ?(.*)"$} $result {wants \1} result
            refuse "[where]: $::command[expr {$::command eq {} || [string index $result 0] eq " " ? {} : {: }}]$result"
        }
        error $result
    }
    return $result
}

# Where a text adds to the structure, by itself or by procedures of the script: its first place; -1: nowhere.
proc builds {text depth} {
    set at 0
    while {[regexp -indices -start $at {(?:^|[\n;\{\[])[ \t]*(#[^\n]*|[^\s;\{\}\[\]\"]+)} $text all word]} {
        set name [string range $text {*}$word]
        if {$name in {model node fix fixX fixY mass equalDOF rigidLink geomTransf section uniaxialMaterial element source} ||
            ($depth > 0 && [string index $name 0] ne "#" && ![catch {interp eval m [list info body $name]} body] &&
             [builds $body [expr {$depth - 1}]] >= 0)} {
            return [lindex $word 0]
        }
        set at [expr {[lindex $word 1] + 1}]
    }
    return -1
}

# Brackets so deep would end Tcl's stack.
proc check_brackets {text shown} {
    set deep 0
    set line 0
    foreach words [split $text \n] {
        incr line
        if {[string match #* [string trimleft $words]]} continue
        set opens [regexp -all {\[} $words]
        if {$deep + $opens > 200} {
            refuse "$shown:$line: brackets in brackets, more than 200 deep"
            error brackets
        }
        set deep [expr {max(0, $deep + $opens - [regexp -all {\]} $words])}]
    }
}

# A fault of Tcl's own is one of the script; where that has asked for an analysis, whose results are not there, and
# adds nothing to the model from there on, the model is complete and the script ends there.
proc run file {
    set shown [expr {$file eq $::file ? $::path : $file}]
    if {![file isfile $file]} {error "$shown is no file"}
    if {[incr ::deep] > 16} {error "16 files that source each other"}
    if {[file size $file] > 1 << 24} {error "[file tail $file] is too large"}
    set in [open $file]
    set text [read $in]
    close $in
    check_brackets $text $shown
    set outer $::level
    set ::level -1
    set code [catch {interp invokehidden m source -encoding utf-8 $file} result options]
    set ::level $outer
    incr ::deep -1
    if {$code == 0} return
    if {$::refused eq {} && !$::ended} {
        set line 0
        foreach {- line} [regexp -all -inline {\(file "[^\n]*" line (\d+)} [dict get $options -errorinfo]] {}
        if {!$::failed} {set ::said [lindex [split $result \n] 0]}
        set rest [string range $text [expr {$line > 1 ? [lindex [regexp -all -indices -inline \n $text] $line-2 0] + 1 : 0}] end]
        if {$::failed} {set rest [regsub {^[^\n]*} $rest {}]}
        set builds [expr {$::analysed ? [builds $rest 4] : -1}]
        set goes_on [expr {$line + [regexp -all {\n} [string range $rest 0 [expr {$builds - 1}]]]}]
        if {[string match "*command count limit exceeded*" $result]} {
            refuse "$::path: takes more than $::commands_max commands"
        } elseif {!$::analysed || ($builds >= 0 && $goes_on == $line)} {
            refuse "$shown:$line: $::said"
        } elseif {$builds >= 0} {
            refuse "$shown:$line: $::said, after an analysis, whose results are not there; line $goes_on goes on with the\
                structure, which must stand before"
        } elseif {!$::failed} {
            note "all from $shown:$line on"
        }
        set ::failed 1
    }
    error $result
}

# ---- the end ------------------------------------------------------------------------------------------------------

# What a rigid arm carries is connected to the node at its other end; arms of what carries nothing come first.
proc carry {} {
    while {$::arms ne {}} {
        set carriers [lmap arm $::arms {lindex $arm 1}]
        set at 0
        while {$at < [llength $::arms] && [lindex $::arms $at 0] in $carriers} {incr at}
        if {$at == [llength $::arms]} {error "rigidLink: a circle of arms"}
        lassign [lindex $::arms $at] node carrier
        set ::arms [lreplace $::arms $at $at]
        if {1 in $::fixed($node) || [array names ::follows $node,*] ne {} || $node in [lmap {- t} [array get ::follows] {set t}]} {
            error "rigidLink: node $node is held or tied besides"
        }
        lassign [span $carrier $node {0 0 0 0}] dx dz
        lassign $::mass($node) m - turning
        set t "mass_of_$node"
        if {$m > 0} {
            set ::element($t) [dict create i $node j $node s {1 1 0} rho 0 mass $m pins {0 0} offsets {0 0 0 0} \
                spring 1 k {0 0 0} axis {1 0}]
            lappend ::elements $t
        }
        foreach t $::elements {
            foreach end {i j} first {0 2} {
                if {[dict get $::element($t) $end] == $node} {
                    set offsets [dict get $::element($t) offsets]
                    lset offsets $first [expr {[lindex $offsets $first] + $dx}]
                    lset offsets $first+1 [expr {[lindex $offsets $first+1] + $dz}]
                    dict set ::element($t) offsets $offsets
                    dict set ::element($t) $end $carrier
                }
            }
        }
        lset ::mass($carrier) 2 [expr {[lindex $::mass($carrier) 2] + $turning}]
        set ::mass($node) {0 0 0}
        tie $node $carrier {1 2 3}
    }
}

# Nodes of a shear model that all stand at one place have no heights: the floors are in the order of the script.
proc stack {} {
    if {$::dofs == 3 || [llength [lsort -unique [lmap t $::nodes {set ::node($t)}]]] > 1} return
    set z 0
    foreach t $::nodes {
        if {![lindex $::fixed($t) 0]} {set ::node($t) [list 0 [incr z]]}
    }
    puts heights
}

# Masses of elements are lumped at their nodes, as OpenSees does; a spring this much stiffer than any beam is rigid, and
# more of it would be lost in rounding.
proc finish {} {
    set rigid 1e7
    set most {0 0}
    foreach t $::elements {
        dict with ::element($t) {
            foreach end [list $i $j] {
                set ::mass($end) [lmap m $::mass($end) to {1 1 0} {expr {$m + 0.5 * $to * $mass}}]
            }
            set mass 0
            if {!$spring} {
                lassign [span $i $j $offsets] dx dz
                set l [expr {hypot($dx, $dz)}]
                set most [lmap was $most now [lrange $s 0 1] times {1 4} {expr {max($was, $times * $now / $l)}}]
            }
        }
    }
    lassign $most along turning
    carry
    foreach t $::elements {
        if {$along > 0} {
            dict set ::element($t) k [lmap k [dict get $::element($t) k] most [list $along $along $turning] {
                expr {min($k, $rigid * $most)}}]
        }
    }
}

# One line for each node, tie and element, in N, m and kg.
proc print_frame {} {
    set L $::length
    set F $::force
    set M [expr {$F / $L}]
    set index -1
    stack
    foreach t $::nodes {
        set at($t) [incr index]
        lassign [concat $::node($t) $::mass($t)] x z mx mz mr
        puts "node $t [expr {$x * $L}] [expr {$z * $L}] $::fixed($t) [expr {$mx * $M}] [expr {$mz * $M}] [expr {$mr * $M * $L * $L}]"
    }
    foreach t $::elements {
        dict with ::element($t) {
            lassign $s EA EI GA
            lassign $k k1 k2 k3
            puts "element $t $at($i) $at($j) [expr {$EA * $F}] [expr {$EI * $F * $L * $L}] [expr {$GA * $F}]\
                [expr {$rho * $F / $L / $L}] [expr {$mass * $M}] $pins [lmap o $offsets {expr {$o * $L}}] $spring\
                [expr {$k1 * $F / $L}] [expr {$k2 * $F / $L}] [expr {$k3 * $F * $L}] $axis"
        }
    }
    foreach {key same_as} [array get ::follows] {
        lassign [split $key ,] t d
        puts "tie $at($t) $at($same_as) $d"
    }
}

# Runs the model and prints "refused TEXT", or the note and the frame.
proc read_model {} {
    interp create -safe m
    interp eval m $::functions
    foreach name {interp after vwait update chan fcopy fileevent fblocked} {catch {interp eval m [list rename $name {}]}}
    foreach name [concat $::skipped [lmap p [info procs ::x::*] {namespace tail $p}]] {
        interp alias m $name {} take $name
    }
    interp alias m pset m set
    interp limit m command -value $::commands_max
    watch m
    set ::shown $::path
    if {[catch {run $::file} result]} {
        if {$::refused eq {} && !$::ended && !$::failed} {set ::refused $result}
    }
    if {$::refused eq {} && $::elements eq {}} {set ::refused "$::path: holds no element"}
    if {$::refused eq {} && [catch finish result]} {set ::refused "$::path: $result"}
    if {$::refused ne {}} {
        puts "refused [string map {\n { }} $::refused]"
    } else {
        puts "note[join [lmap word $::notes {set word " $word,"}] {}]"
        print_frame
    }
}
