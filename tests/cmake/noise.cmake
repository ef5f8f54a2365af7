# Sampling noise: the kinds and the table, off the device and on it.
nf_test(noise_test nf_passes LABELS cpu)
nf_test(gpu_noise_test nf_gpu_fixture LABELS gpu)
foreach(name noise_test gpu_noise_test)
  target_include_directories(${name} PRIVATE ${CMAKE_SOURCE_DIR}/shaders ${CMAKE_CURRENT_SOURCE_DIR})
endforeach()
