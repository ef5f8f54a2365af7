// load_gltf: the order of an import, and the one place where its problems become errors.
#include "scene/gltf.h"

#include <cmath>

#include "core/error.h"
#include "core/log.h"
#include "scene/gltf_import.h"
#include "scene/text.h"
#include "scene/update.h"

namespace nf::scene {

namespace gltf {

void Importer::warn_once(const std::string& message) {
  if (warned.insert(message).second) log::warn("'{}': {}", source.path, message);
}

std::string describe(const char* section, size_t row, const std::string& name) {
  return name.empty() ? fmt::format("{} {}", section, row) : fmt::format("{} {} '{}'", section, row, one_line(name));
}

namespace {

size_t buffer_row(const std::string& name) {
  const size_t dash = name.rfind('-');
  return dash == std::string::npos ? ~size_t(0) : std::stoul(name.substr(dash + 1));
}

}  // namespace

// tinygltf works on memory alone: its file callbacks know the buffers by the names load_source gave them, nothing else.
tinygltf::Model parse_model(Source& source) {
  tinygltf::FsCallbacks files;
  files.FileExists = [](const std::string& name, void* user) {
    return buffer_row(name) < static_cast<Source*>(user)->buffers.size();
  };
  files.ExpandFilePath = [](const std::string& name, void*) { return name; };
  files.ReadWholeFile = [](std::vector<unsigned char>* bytes, std::string*, const std::string& name, void* user) {
    *bytes = std::move(static_cast<Source*>(user)->buffers.at(buffer_row(name)));
    return true;
  };
  files.WriteWholeFile = nullptr;
  files.user_data = &source;

  tinygltf::TinyGLTF parser;
  parser.SetFsCallbacks(files);
  tinygltf::Model model;
  std::string error, warning;
  const std::string text = source.document.dump();
  const bool parsed = parser.LoadASCIIFromString(&model, &error, &warning, text.data(), unsigned(text.size()), "");
  if (!parsed || !error.empty()) {
    refuse("{}", error.empty() ? "its structure is broken" : one_line(error.substr(0, error.find('\n'))));
  }
  return model;
}

namespace {

bool finite(const mat4& matrix) {
  for (int i = 0; i < 16; ++i) {
    if (!std::isfinite(matrix[i / 4][i % 4])) return false;
  }
  return true;
}

void check_extent(const Scene& scene) {
  constexpr float limit = 1e9f;
  for (size_t i = 0; i < scene.nodes.size(); ++i) {
    if (!finite(scene.nodes.world[i])) {
      refuse("{} has a transform that is not finite", describe("node", i, scene.nodes.name[i]));
    }
  }
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const vec3 reach = glm::abs(scene.instances.center[i]) + scene.instances.extent[i];
    const bool sane = reach.x < limit && reach.y < limit && reach.z < limit;
    const uint32_t node = scene.instances.node[i];
    if (!sane) refuse("{} reaches beyond 1e9 m", describe("node", node, scene.nodes.name[node]));
  }
}

// One warning for each extension that is left out.
void warn_ignored(Importer& importer) {
  const nlohmann::json& document = importer.source.document;
  if (!document.contains("extensionsUsed")) return;
  for (const nlohmann::json& entry : document["extensionsUsed"]) {
    const std::string& name = entry.get_ref<const std::string&>();
    if (name == "KHR_mesh_quantization") importer.quantized = true;
    if (!is_supported(name)) importer.warn_once(fmt::format("the extension {} is ignored", one_line(name)));
  }
}

Scene import_scene(const std::filesystem::path& path, const PictureProgress& progress) {
  Source source = load_source(path);
  Budget budget(source.bytes);
  decompress(source, budget);
  decompress_draco(source, budget);
  strip(source.document);
  const tinygltf::Model model = parse_model(source);
  Scene scene;
  scene.path = source.path;
  Importer importer{.model = model, .source = source, .scene = scene, .budget = budget};
  warn_ignored(importer);
  import_materials(importer);
  const std::vector<uint32_t> file_node = import_nodes(importer);
  if (scene.triangles() == 0) refuse("it has no triangles");
  import_animations(importer);
  // Twice, so that what was before is what is now.
  update_transforms(scene);
  update(scene);
  check_extent(scene);
  import_cameras(importer, file_node);
  import_lights(importer, file_node);
  import_pictures(importer, progress);
  return scene;
}

}  // namespace

}  // namespace gltf

Scene load_gltf(const std::filesystem::path& path, const PictureProgress& progress) {
  const std::string name = one_line(path.string(), 1000);
  try {
    const Doing doing("loading " + name);
    return gltf::import_scene(path, progress);
  } catch (const gltf::Problem& problem) {
    fail(Exit::Input, "cannot load '{}': {}; {}", name, problem.what, problem.advice);
  } catch (const std::bad_alloc&) {
    fail(Exit::Input, "cannot load '{}': it needs more memory than there is; use a smaller scene", name);
  } catch (const std::length_error&) {
    fail(Exit::Input, "cannot load '{}': a size in it is absurd; {}", name, gltf::advice_reexport);
  } catch (const std::exception& e) {
    // The libraries' own exceptions; our checks should leave them no reason.
    fail(Exit::Input, "cannot load '{}': {}; {}", name, one_line(e.what()), gltf::advice_reexport);
  }
}

}  // namespace nf::scene
