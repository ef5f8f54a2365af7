// vulkan.h comes first, so that GLFW knows of surfaces.
#include "gpu/swapchain.h"
// clang-format off
#include <GLFW/glfw3.h>
// clang-format on

#include "window.h"

namespace nf::editor {
namespace {

ui::InputQueue& queue_of(GLFWwindow* window) {
  return *static_cast<ui::InputQueue*>(glfwGetWindowUserPointer(window));
}

std::string last_error() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text ? text : "no reason was given";
}

using ui::InputKind;

void listen(GLFWwindow* window) {
  glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) {
    int ww = 1, wh = 1, fw = 1, fh = 1;
    glfwGetWindowSize(w, &ww, &wh);
    glfwGetFramebufferSize(w, &fw, &fh);
    const float sx = ww > 0 ? float(fw) / float(ww) : 1, sy = wh > 0 ? float(fh) / float(wh) : 1;
    queue_of(w).push({.kind = InputKind::Move, .x = float(x) * sx, .y = float(y) * sy});
  });
  glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int mods) {
    queue_of(w).push({.kind = InputKind::Button, .code = button, .down = action != GLFW_RELEASE, .mods = mods});
  });
  glfwSetScrollCallback(window, [](GLFWwindow* w, double x, double y) {
    queue_of(w).push({.kind = InputKind::Wheel, .x = float(x), .y = float(y)});
  });
  glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int mods) {
    queue_of(w).push({.kind = InputKind::Key, .code = key, .down = action != GLFW_RELEASE, .mods = mods});
  });
  glfwSetCharCallback(
      window, [](GLFWwindow* w, unsigned code) { queue_of(w).push({.kind = InputKind::Char, .code = int(code)}); });
  glfwSetDropCallback(window, [](GLFWwindow* w, int count, const char** paths) {
    for (int i = 0; i < count; ++i) queue_of(w).push({.kind = InputKind::Drop, .text = paths[i]});
  });
  glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int x, int y) {
    queue_of(w).push({.kind = InputKind::Resize, .x = float(x), .y = float(y)});
  });
  glfwSetWindowContentScaleCallback(
      window, [](GLFWwindow* w, float x, float) { queue_of(w).push({.kind = InputKind::Scale, .x = x}); });
  glfwSetWindowFocusCallback(window, [](GLFWwindow* w, int focused) {
    queue_of(w).push({.kind = InputKind::Focus, .down = focused == GLFW_TRUE});
  });
  glfwSetWindowCloseCallback(window, [](GLFWwindow* w) { queue_of(w).push({.kind = InputKind::Close}); });
}

}  // namespace

Window::Window(glm::uvec2 size, const std::string& title, ui::InputQueue& input) {
  if (!glfwInit())
    fail(Exit::NoDevice,
         "no window can be opened: {}; start it in a graphical session, or use a command, e.g. nearfield "
         "render SCENE -o picture.png",
         last_error());
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
  window_ = glfwCreateWindow(int(size.x), int(size.y), title.c_str(), nullptr, nullptr);
  if (!window_) {
    const std::string why = last_error();
    glfwTerminate();
    fail(Exit::NoDevice,
         "no window can be opened: {}; use a command instead, e.g. nearfield render SCENE -o picture.png", why);
  }
  glfwSetWindowUserPointer(window_, &input);
  glfwSetWindowSizeLimits(window_, 1, 1, GLFW_DONT_CARE, GLFW_DONT_CARE);
  listen(window_);
}

Window::~Window() {
  swapchain_.reset();
  glfwDestroyWindow(window_);
  glfwTerminate();
}

std::vector<std::string> Window::extensions() const {
  uint32_t count = 0;
  const char** names = glfwGetRequiredInstanceExtensions(&count);
  if (!names) fail(Exit::NoDevice, "Vulkan shows no pictures in windows here: {}; install a driver", last_error());
  return {names, names + count};
}

void Window::attach(gpu::Device& device) {
  VkSurfaceKHR surface = VK_NULL_HANDLE;
  NF_VK(glfwCreateWindowSurface(device.instance, window_, nullptr, &surface));
  swapchain_ = std::make_unique<gpu::Swapchain>(device, surface);
}

void Window::detach() {
  swapchain_.reset();
}

void Window::present(glm::uvec2 size, std::span<const std::byte> rgba) {
  swapchain_->present({size.x, size.y}, rgba);
}

void Window::poll(double seconds) {
  if (seconds > 0)
    glfwWaitEventsTimeout(seconds);
  else
    glfwPollEvents();
}

void Window::set_title(const std::string& title) {
  glfwSetWindowTitle(window_, title.c_str());
}
void Window::set_size(glm::uvec2 size) {
  glfwSetWindowSize(window_, int(size.x), int(size.y));
}

void Window::toggle_fullscreen() {
  if (glfwGetWindowMonitor(window_)) {
    glfwSetWindowMonitor(window_, nullptr, windowed_.x, windowed_.y, windowed_.z, windowed_.w, 0);
    return;
  }
  GLFWmonitor* monitor = glfwGetPrimaryMonitor();
  const GLFWvidmode* mode = monitor ? glfwGetVideoMode(monitor) : nullptr;
  if (!mode) return;
  glfwGetWindowPos(window_, &windowed_.x, &windowed_.y);
  glfwGetWindowSize(window_, &windowed_.z, &windowed_.w);
  glfwSetWindowMonitor(window_, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
}

glm::uvec2 Window::size() const {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  return {uint32_t(std::max(width, 0)), uint32_t(std::max(height, 0))};
}

float Window::scale() const {
  float x = 1, y = 1;
  glfwGetWindowContentScale(window_, &x, &y);
  return x > 0 ? x : 1;
}

std::string Window::clipboard() const {
  const char* text = glfwGetClipboardString(window_);
  return text ? text : "";
}
void Window::set_clipboard(const std::string& text) {
  glfwSetClipboardString(window_, text.c_str());
}

}  // namespace nf::editor
