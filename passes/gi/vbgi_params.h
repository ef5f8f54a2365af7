// Private parameters of the visibility-bitmask GI pass, radiometric form; the shared ones are in gi_params.h.
#pragma once

#define NF_VBGI_PARAMS(P)                                                                                            \
  P(Choice, slice_measure, 1, 0, 2, "screen|screen_j|view",                                                          \
    "Slice directions: uniform on the screen, the same with the azimuth weight J, or uniform about the view vector") \
  P(Choice, sector_rule, 0, 0, 1, "jitter|round",                                                                    \
    "End points on sectors: one random offset per slice, or the nearest")                                            \
  P(Choice, emitter, 0, 0, 1, "one_sided|none", "Whether a surface lights only what is in front of it")
