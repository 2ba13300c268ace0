* A cantilever with a load at its end [N, mm, MPa]
width    {x1}
height   {x2}
material {x3}
length   1000
load     2000
