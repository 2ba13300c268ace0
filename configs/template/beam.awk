# A solver that reads one file and writes another, as many old ones do: the cantilever of beam.tpl.
$1 == "width" { b = $2 }
$1 == "height" { h = $2 }
$1 == "length" { l = $2 }
$1 == "load" { P = $2 }
$1 == "material" { E = $2 == "steel" ? 210000 : 70000; rho = $2 == "steel" ? 7.85e-6 : 2.7e-6; s = $2 == "steel" ? 235 : 160 }
END {
    print "CANTILEVER 1.0"
    printf "MASS       = %.9g kg\n", rho * b * h * l
    printf "DEFLECTION = %.9g mm\n", 4 * P * l ^ 3 / (E * b * h ^ 3)
    printf "STRESS     = %.9g\n", 6 * P * l / (b * h ^ 2) / s - 1
}
