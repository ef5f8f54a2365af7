# What needs more than the build: a browser, a cluster. They skip, and say why, where that is not there; `./test.sh --all`
# installs it.
add_test(NAME report_in_browser
         COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/browser/run.sh $<TARGET_FILE:nearfield> ${CMAKE_BINARY_DIR}/content/cornell.glb
                 ${CMAKE_BINARY_DIR}/browser)
add_test(NAME sweep_through_slurm
         COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/slurm/run.sh $<TARGET_FILE:nearfield> ${CMAKE_BINARY_DIR}/content/cornell.glb
                 ${CMAKE_BINARY_DIR}/slurm_test)
set_tests_properties(report_in_browser sweep_through_slurm PROPERTIES LABELS all TIMEOUT 300 SKIP_RETURN_CODE 77)
