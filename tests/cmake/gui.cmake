# The editor. Scripts drive it without a window; tests/gui/window.sh with a real one, where Xvfb and xdotool are there.
nf_test(gui_test nf_image nf_capture LABELS gui)
add_dependencies(gui_test nearfield nearfield_scenes)
nf_test(gpu_handover_test nf_editor nf_gpu_fixture LABELS gui)
nf_test(editor_test nf_editor LABELS cpu.editor)
add_test(NAME gui.window COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/gui/window.sh ${CMAKE_BINARY_DIR})
set_tests_properties(gui.window PROPERTIES LABELS gui TIMEOUT 180 SKIP_RETURN_CODE 77 RUN_SERIAL ON)
