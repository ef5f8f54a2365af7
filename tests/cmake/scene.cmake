foreach(name scene_test scene_node_test scene_surface_test scene_motion_test scene_models_test view_test bad_scene_test bad_scene_file_test)
  nf_test(${name} nf_scene LABELS cpu)
endforeach()
# These make compressed files with the libraries' own encoders.
foreach(name scene_packed_test scene_mutation_test)
  nf_test(${name} nf_scene meshoptimizer::meshoptimizer ${NF_DRACO} LABELS cpu)
endforeach()
nf_test(scene_content_test nf_scene nf_content LABELS cpu)
