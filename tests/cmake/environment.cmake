# Environments: maps, spherical harmonics and prefiltered mips off the device; background and ambient light on it.
nf_test(environment_test nf_scene nf_content LABELS cpu)
nf_test(gpu_environment_test nf_gpu_fixture LABELS gpu)
