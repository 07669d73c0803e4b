// Glass merged from balls, and from a ball and a box. CC0.
#version 3.7;
global_settings { assumed_gamma 1 max_trace_level 10 }
#default { finish { ambient 0.1 diffuse 0.7 } }
background { rgb <0.08,0.16,0.30> }
camera { location <3.2,-5,3> sky z up y right -x*image_width/image_height
  angle degrees(2*atan(tan(radians(45)/2)*image_width/image_height)) look_at <0,0,0> }
light_source { <-4,-5,6> rgb <1,1,1> }
plane { z, -1.5 pigment { checker rgb <0.9,0.9,0.2> rgb <0.8,0.1,0.1> } }
#declare GL = material { texture { pigment { rgbt <1,1,1,1> } finish { ambient 0 diffuse 0 } } interior { ior 1.4 } }
merge { sphere { <-0.4,0,0>, 0.8 } sphere { <0.4,0,0.3>, 0.8 } rotate z*30 translate <-1.3,-0.5,0> material { GL } }
merge { sphere { <-0.2,0,0.3>, 0.7 } box { <-0.6,-0.6,-0.8>, <0.6,0.6,0.1> } rotate z*30 translate <1.2,0.5,0> material { GL } }
