# Environments: maps, spherical harmonics and prefiltered mips, off the device.
nf_test(environment_test nf_scene nf_content LABELS cpu)
