# Denoising, temporal accumulation, antialiasing.
nf_test(reconstruction_test nf_passes LABELS cpu)
target_include_directories(reconstruction_test PRIVATE ${CMAKE_SOURCE_DIR}/shaders ${CMAKE_CURRENT_SOURCE_DIR})
nf_test(gpu_reconstruction_test nf_gpu_fixture LABELS gpu)
nf_test(gpu_resolution_test nf_gpu_fixture LABELS gpu)
