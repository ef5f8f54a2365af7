# The layering of the rooms: a scan of the sources, and tries with the compiler and the targets' own include folders.
set(layering_engine)
foreach(room core image scene gpu graph capture reference)
  if(TARGET nf_${room})
    list(APPEND layering_engine "$<TARGET_PROPERTY:nf_${room},INCLUDE_DIRECTORIES>")
  endif()
endforeach()
add_test(NAME layering
         COMMAND ${CMAKE_COMMAND} -DROOT=${CMAKE_SOURCE_DIR} -DWORK=${CMAKE_CURRENT_BINARY_DIR}/layering -DCXX=${CMAKE_CXX_COMPILER}
                 "-DENGINE_INCLUDES=$<JOIN:${layering_engine},|>"
                 "-DPASSES_INCLUDES=$<JOIN:$<TARGET_PROPERTY:nf_passes,INCLUDE_DIRECTORIES>,|>"
                 "-DDEFINES=$<JOIN:$<TARGET_PROPERTY:nf_passes,COMPILE_DEFINITIONS>,|>"
                 -P ${CMAKE_CURRENT_SOURCE_DIR}/layering_test.cmake)
set_tests_properties(layering PROPERTIES LABELS cpu TIMEOUT 120)
