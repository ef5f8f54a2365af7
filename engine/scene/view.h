// View files (JSON): one camera and, optionally, the lights. The format is documented in the README's "View files".
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace nf::scene {

// Each member that is present replaces the scene's lights of that kind.
struct View {
  std::optional<Camera> camera;
  std::optional<std::vector<DirectionalLight>> directional;
  std::optional<std::vector<PunctualLight>> point;
  std::optional<Environment> environment;
};

// Throws nf::Error (Exit::Input): missing file, bad JSON, an unknown key (named by its path, e.g. "camera.fov"), a
// wrong type or a non-finite number, a degenerate camera (target == position, up parallel to the view, vfov outside
// (0,180), near <= 0), an environment of two kinds at once, or whose map cannot be read (its path is relative to the
// view file).
View load_view(const std::filesystem::path& path);
// The same of an object inside another file, at JSON path `at` ("" = the file itself): `file` names it in messages, an
// environment map's path is relative to `folder`.
View parse_view(const nlohmann::json& value, const std::string& file, const std::filesystem::path& folder,
                const std::string& at = "");
// What parse_view() reads back: to the last bit, but for directions and angles, which it makes anew (1e-6).
// A map's path is written relative to `folder` where it lies in it, else absolute. Throws nf::Error (Exit::Output) for
// a map that came from no file.
nlohmann::json to_json(const View& view, const std::filesystem::path& folder);
// One camera: a view's "camera".
Camera parse_camera(const nlohmann::json& value, const std::string& file, const std::string& at);
nlohmann::json to_json(const Camera& camera);
void apply_view(const View& view, Scene& scene);

// What --view means: a .json file, a camera's name, or its number; empty = the scene's first camera, or a framing of
// the bounds where there is none. Replaces lights too when it is a file. Throws nf::Error (Exit::Input) naming the
// cameras there are.
Camera select_view(const std::string& view, Scene& scene);

// A camera that sees the whole box from a raised three-quarter angle.
Camera frame_bounds(const Bounds& bounds);

}  // namespace nf::scene
