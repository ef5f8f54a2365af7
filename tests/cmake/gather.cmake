# ssao, ssdo, raymarch, hbil, likewise; and on the device.
foreach(name gather_test hbil_test)
  nf_test(${name} nf_core glm::glm LABELS cpu)
  target_include_directories(${name} PRIVATE ${CMAKE_SOURCE_DIR}/shaders ${CMAKE_SOURCE_DIR}/passes ${CMAKE_CURRENT_SOURCE_DIR})
endforeach()
nf_test(gpu_gather_test nf_gpu_fixture LABELS gpu)
target_include_directories(gpu_gather_test PRIVATE ${CMAKE_SOURCE_DIR}/shaders ${CMAKE_CURRENT_SOURCE_DIR})
# The presets against their formulas.
nf_test(preset_test nf_passes LABELS cpu)
target_include_directories(preset_test PRIVATE ${CMAKE_SOURCE_DIR}/shaders ${CMAKE_CURRENT_SOURCE_DIR})
