// Loading, and the choice of a variant.
#include "cli/scene_input.h"

#include <algorithm>
#include <memory>

#include "cli/progress.h"
#include "scene/gltf.h"
#include "scene/view.h"

namespace nf::editor {
namespace {

uint32_t find_variant(const scene::Scene& scene, const std::string& name) {
  const auto found = std::find(scene.variants.begin(), scene.variants.end(), name);
  if (found != scene.variants.end()) return uint32_t(found - scene.variants.begin());
  std::string names;
  for (const std::string& variant : scene.variants) names += fmt::format("{}'{}'", names.empty() ? "" : ", ", variant);
  if (names.empty()) fail(Exit::Input, "no variant '{}': '{}' has none; leave --variant away", name, scene.path);
  fail(Exit::Input, "no variant '{}' in '{}': there are {}", name, scene.path, names);
}

}  // namespace

scene::Scene open_scene(const std::string& path, const CommonOptions& options) {
  std::unique_ptr<Progress> progress;
  scene::Scene scene = scene::load_gltf(path, [&](size_t done, size_t total) {
    if (!progress) progress = std::make_unique<Progress>("pictures", total, options);
    progress->update(done);
  });
  if (!options.variant.empty()) select_variant(scene, find_variant(scene, options.variant));
  return scene;
}

scene::Camera choose_view(const CommonOptions& options, scene::Scene& scene) {
  if (!options.preset_view) return scene::select_view(options.view, scene);
  scene::apply_view(*options.preset_view, scene);
  return options.preset_view->camera ? *options.preset_view->camera : scene::select_view("", scene);
}

}  // namespace nf::editor
