# The binary as a process: exit codes, streams, files.
foreach(name cli_test cli_error_test cli_evaluate_test cli_bench_test cli_sweep_test)
  nf_test(${name} nf_image LABELS gpu)
  add_dependencies(${name} nearfield nearfield_scenes)
endforeach()
target_link_libraries(cli_bench_test PRIVATE nf_capture)
# Commands that need no device. `cpu.editor` is left out where the program is not built, under the sanitizers.
foreach(name cli_compare_test cli_reference_test)
  nf_test(${name} nf_image LABELS cpu.editor)
  add_dependencies(${name} nearfield nearfield_scenes)
endforeach()
# Parts of the program that need no process.
foreach(name preset_file_test live_reference_test live_split_test)
  nf_test(${name} nf_editor nf_content LABELS cpu.editor)
endforeach()
add_test(NAME installed COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/installed.sh ${CMAKE_BINARY_DIR})
set_tests_properties(installed PROPERTIES LABELS gpu TIMEOUT 300)
