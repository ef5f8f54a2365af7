// Instance, choice of the physical device, logical device and validation messages.
#include "gpu/device.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>

#include "core/log.h"
#include "gpu/renderdoc.h"

namespace nf::gpu {
namespace {

constexpr const char* validation_layer = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                          VkDebugUtilsMessageTypeFlagsEXT,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  std::string where;
  for (uint32_t i = 0; i < data->cmdBufLabelCount; ++i) {
    const std::string label = fmt::format(" [{}]", data->pCmdBufLabels[i].pLabelName);
    if (!where.ends_with(label)) where += label;  // the layer tells one twice
  }
  // What no command buffer is at: a pipeline that is made, a submission.
  if (where.empty() && !Doing::current().empty()) where = fmt::format(" [{}]", Doing::current());
  const std::string text = fmt::format("validation{}: {}", where, data->pMessage);
  if (severity >= VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT)
    log::error("{}", text);
  else
    log::warn("{}", text);
  static_cast<Device*>(user)->add_message(text);
  return VK_FALSE;
}

bool layer_present() {
  uint32_t count = 0;
  vkEnumerateInstanceLayerProperties(&count, nullptr);
  std::vector<VkLayerProperties> layers(count);
  vkEnumerateInstanceLayerProperties(&count, layers.data());
  return std::any_of(layers.begin(), layers.end(),
                     [](const auto& l) { return !std::strcmp(l.layerName, validation_layer); });
}

VkInstance create_instance(bool validation, const std::vector<std::string>& window_extensions = {}) {
  if (validation && !layer_present())
    fail(Exit::NoDevice, "cannot turn validation on: the layer {} is not installed; install vulkan-validationlayers",
         validation_layer);
  // Hazards between submissions are only found with this switch, which has no other interface in the layer's 1.3.239.
  if (validation)
    setenv("VK_LAYER_ENABLES",
           "VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT:"
           "VALIDATION_CHECK_ENABLE_SYNCHRONIZATION_VALIDATION_QUEUE_SUBMIT",
           0);
  VkApplicationInfo app{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                        .pApplicationName = "nearfield",
                        .pEngineName = "nearfield",
                        .apiVersion = VK_API_VERSION_1_3};
  std::vector<const char*> extensions = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME};
  for (const std::string& name : window_extensions) extensions.push_back(name.c_str());
  VkInstanceCreateInfo create{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                              .pApplicationInfo = &app,
                              .enabledLayerCount = validation ? 1u : 0u,
                              .ppEnabledLayerNames = &validation_layer,
                              .enabledExtensionCount = uint32_t(extensions.size()),
                              .ppEnabledExtensionNames = extensions.data()};
  VkInstance instance = VK_NULL_HANDLE;
  const VkResult result = vkCreateInstance(&create, nullptr, &instance);
  if (result != VK_SUCCESS)
    fail(Exit::NoDevice, "cannot start Vulkan: {}; install a driver (Debian: mesa-vulkan-drivers has a software one)",
         result_name(result));
  return instance;
}

// The features we enable, chained; `missing` names what the device lacks.
struct Features {
  VkPhysicalDeviceVulkan13Features v13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
  VkPhysicalDeviceVulkan12Features v12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
  VkPhysicalDeviceVulkan11Features v11{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES};
  VkPhysicalDeviceFeatures2 base{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
  void chain() { base.pNext = &v11, v11.pNext = &v12, v12.pNext = &v13; }
};

template <class Visit>
void needed_features(Features& f, Visit visit) {
  visit(f.v13.dynamicRendering, "dynamicRendering");
  visit(f.v13.synchronization2, "synchronization2");
  visit(f.v13.maintenance4, "maintenance4");
  visit(f.v12.timelineSemaphore, "timelineSemaphore");
  visit(f.v12.scalarBlockLayout, "scalarBlockLayout");
  visit(f.v12.hostQueryReset, "hostQueryReset");
  visit(f.v11.shaderDrawParameters, "shaderDrawParameters");
  visit(f.base.features.multiDrawIndirect, "multiDrawIndirect");
  visit(f.base.features.drawIndirectFirstInstance, "drawIndirectFirstInstance");
  visit(f.base.features.shaderStorageImageWriteWithoutFormat, "shaderStorageImageWriteWithoutFormat");
  visit(f.base.features.shaderStorageImageExtendedFormats, "shaderStorageImageExtendedFormats");
  visit(f.base.features.fragmentStoresAndAtomics, "fragmentStoresAndAtomics");
  visit(f.base.features.independentBlend, "independentBlend");
}

uint32_t find_queue_family(VkPhysicalDevice physical) {
  uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
  constexpr VkQueueFlags wanted = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
  for (uint32_t i = 0; i < count; ++i)
    if ((families[i].queueFlags & wanted) == wanted) return i;
  return ~0u;
}

bool has_extension(VkPhysicalDevice physical, const char* name) {
  uint32_t count = 0;
  vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> extensions(count);
  vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, extensions.data());
  return std::any_of(extensions.begin(), extensions.end(),
                     [&](const auto& e) { return !std::strcmp(e.extensionName, name); });
}

// Whether timestamps and CLOCK_MONOTONIC can be read at one moment.
bool has_calibrated_clock(VkInstance instance, VkPhysicalDevice physical) {
  if (!has_extension(physical, VK_EXT_CALIBRATED_TIMESTAMPS_EXTENSION_NAME)) return false;
  const auto list = reinterpret_cast<PFN_vkGetPhysicalDeviceCalibrateableTimeDomainsEXT>(
      vkGetInstanceProcAddr(instance, "vkGetPhysicalDeviceCalibrateableTimeDomainsEXT"));
  uint32_t count = 0;
  if (!list || list(physical, &count, nullptr) != VK_SUCCESS) return false;
  std::vector<VkTimeDomainEXT> domains(count);
  list(physical, &count, domains.data());
  const auto has = [&](VkTimeDomainEXT domain) { return std::count(domains.begin(), domains.end(), domain) > 0; };
  return has(VK_TIME_DOMAIN_DEVICE_EXT) && has(VK_TIME_DOMAIN_CLOCK_MONOTONIC_EXT);
}

std::string find_missing(VkPhysicalDevice physical) {
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(physical, &properties);
  if (properties.apiVersion < VK_API_VERSION_1_3)
    return fmt::format("Vulkan 1.3 ({} {}.{})", renderdoc_loaded() ? "RenderDoc's layer lets through" : "it has",
                       VK_API_VERSION_MAJOR(properties.apiVersion), VK_API_VERSION_MINOR(properties.apiVersion));
  std::vector<std::string> missing;
  if (find_queue_family(physical) == ~0u) missing.emplace_back("a queue with graphics and compute");
  if (!has_extension(physical, VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME))
    missing.emplace_back(VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME);
  Features features;
  features.chain();
  vkGetPhysicalDeviceFeatures2(physical, &features.base);
  needed_features(features, [&](VkBool32 has, const char* name) {
    if (!has) missing.emplace_back(name);
  });
  return fmt::format("{}", fmt::join(missing, ", "));
}

const char* type_name(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return "cpu";
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return "discrete gpu";
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return "integrated gpu";
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return "virtual gpu";
    default:
      return "other";
  }
}

std::vector<VkPhysicalDevice> enumerate(VkInstance instance) {
  uint32_t count = 0;
  vkEnumeratePhysicalDevices(instance, &count, nullptr);
  std::vector<VkPhysicalDevice> devices(count);
  if (count) vkEnumeratePhysicalDevices(instance, &count, devices.data());
  devices.resize(count);
  return devices;
}

DeviceInfo describe(VkPhysicalDevice physical, uint32_t index) {
  VkPhysicalDeviceDriverProperties driver{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &driver};
  vkGetPhysicalDeviceProperties2(physical, &properties);
  const uint32_t api = properties.properties.apiVersion;
  return {
      .name = properties.properties.deviceName,
      .type = type_name(properties.properties.deviceType),
      .driver = driver.driverName,
      .driver_info = driver.driverInfo,
      .api = fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(api), VK_API_VERSION_MINOR(api), VK_API_VERSION_PATCH(api)),
      .index = index,
      .missing = find_missing(physical)};
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

// Among the usable devices that `select` allows: discrete before integrated before virtual before software.
uint32_t choose(const std::vector<DeviceInfo>& devices, const std::string& select) {
  if (devices.empty())
    fail(Exit::NoDevice,
         "no Vulkan device: no driver was found; install one (Debian: mesa-vulkan-drivers has a software one)");
  const std::string wanted = lower(select);
  uint32_t number = 0;
  const auto [end, error] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), number);
  const bool by_index = !wanted.empty() && error == std::errc() && end == wanted.data() + wanted.size();
  static const std::vector<std::string> order = {"discrete gpu", "integrated gpu", "virtual gpu", "cpu", "other"};
  uint32_t best = ~0u;
  size_t best_rank = order.size();
  std::string reasons, names;
  for (const DeviceInfo& d : devices) {
    names += fmt::format("{}{}: {}", names.empty() ? "" : ", ", d.index, d.name);
    const bool matches = wanted.empty() || (by_index          ? d.index == number
                                            : wanted == "cpu" ? d.type == "cpu"
                                            : wanted == "gpu" ? d.type.find("gpu") != std::string::npos
                                                              : lower(d.name).find(wanted) != std::string::npos);
    if (!matches) continue;
    if (!d.missing.empty()) {
      reasons += fmt::format("{}{} lacks {}", reasons.empty() ? "" : "; ", d.name, d.missing);
      continue;
    }
    const size_t rank = size_t(std::find(order.begin(), order.end(), d.type) - order.begin());
    if (rank < best_rank) best = d.index, best_rank = rank;
  }
  if (best != ~0u) return best;
  if (!reasons.empty())
    fail(Exit::NoDevice, "no suitable Vulkan device: {}; update the driver or choose another with --device", reasons);
  fail(Exit::NoDevice, "no Vulkan device matches '{}': there are {}; choose one with --device INDEX, NAME, cpu or gpu",
       select, names);
}

}  // namespace

const char* result_name(VkResult result) {
  switch (result) {
    case VK_SUCCESS:
      return "VK_SUCCESS";
    case VK_NOT_READY:
      return "VK_NOT_READY";
    case VK_TIMEOUT:
      return "VK_TIMEOUT";
    case VK_INCOMPLETE:
      return "VK_INCOMPLETE";
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      return "VK_ERROR_OUT_OF_HOST_MEMORY";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      return "VK_ERROR_OUT_OF_DEVICE_MEMORY";
    case VK_ERROR_INITIALIZATION_FAILED:
      return "VK_ERROR_INITIALIZATION_FAILED";
    case VK_ERROR_DEVICE_LOST:
      return "VK_ERROR_DEVICE_LOST";
    case VK_ERROR_LAYER_NOT_PRESENT:
      return "VK_ERROR_LAYER_NOT_PRESENT";
    case VK_ERROR_EXTENSION_NOT_PRESENT:
      return "VK_ERROR_EXTENSION_NOT_PRESENT";
    case VK_ERROR_FEATURE_NOT_PRESENT:
      return "VK_ERROR_FEATURE_NOT_PRESENT";
    case VK_ERROR_INCOMPATIBLE_DRIVER:
      return "VK_ERROR_INCOMPATIBLE_DRIVER";
    case VK_ERROR_FORMAT_NOT_SUPPORTED:
      return "VK_ERROR_FORMAT_NOT_SUPPORTED";
    default:
      return "an unnamed VkResult";
  }
}

void check(VkResult result, const char* call, const char* file, int line) {
  if (result == VK_SUCCESS) return;
  const std::string where = Doing::current().empty() ? "" : " while " + Doing::current();
  if (result == VK_ERROR_DEVICE_LOST)
    fail(Exit::Gpu, "the GPU was lost{}: {}; try --validation, a smaller --size, or --device cpu", where, call);
  if (result == VK_ERROR_OUT_OF_DEVICE_MEMORY || result == VK_ERROR_OUT_OF_HOST_MEMORY)
    fail(Exit::Gpu, "out of GPU memory{}: {}; try a smaller --size", where, call);
  check_failed(call, result_name(result), file, line);
}

Device::Device(const DeviceOptions& options) {
  validation = options.validation;
  instance = create_instance(validation, options.window_extensions);
  const auto physicals = enumerate(instance);
  std::vector<DeviceInfo> infos;
  for (uint32_t i = 0; i < physicals.size(); ++i) infos.push_back(describe(physicals[i], i));
  uint32_t chosen = 0;
  try {
    chosen = choose(infos, options.select);
  } catch (...) {
    vkDestroyInstance(instance, nullptr);
    throw;
  }
  physical = physicals[chosen];
  info = infos[chosen];
  vkGetPhysicalDeviceProperties(physical, &properties);
  vkGetPhysicalDeviceMemoryProperties(physical, &memory);
  queue_family = find_queue_family(physical);

  if (validation) {
    VkDebugUtilsMessengerCreateInfoEXT create{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
                                              .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                                                                 VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
                                              .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
                                              .pfnUserCallback = on_message,
                                              .pUserData = this};
    auto create_messenger = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(instance, "vkCreateDebugUtilsMessengerEXT"));
    NF_VK(create_messenger(instance, &create, nullptr, &messenger_));
  }

  Features features;
  features.chain();
  needed_features(features, [](VkBool32& wanted, const char*) { wanted = VK_TRUE; });
  VkPhysicalDeviceFeatures available;
  vkGetPhysicalDeviceFeatures(physical, &available);
  features.base.features.samplerAnisotropy = available.samplerAnisotropy;
  features.base.features.pipelineStatisticsQuery = available.pipelineStatisticsQuery;

  uint32_t family_count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &family_count, nullptr);
  std::vector<VkQueueFamilyProperties> families(family_count);
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &family_count, families.data());
  queues = options.second_queue ? std::min(families[queue_family].queueCount, 2u) : 1;
  const float priorities[2] = {1, 1};
  VkDeviceQueueCreateInfo queue_create{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                       .queueFamilyIndex = queue_family,
                                       .queueCount = queues,
                                       .pQueuePriorities = priorities};
  std::vector<const char*> extensions = {VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME};
  const bool calibrated = has_calibrated_clock(instance, physical);
  if (calibrated) extensions.push_back(VK_EXT_CALIBRATED_TIMESTAMPS_EXTENSION_NAME);
  if (!options.window_extensions.empty()) extensions.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
  VkDeviceCreateInfo create{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                            .pNext = &features.base,
                            .queueCreateInfoCount = 1,
                            .pQueueCreateInfos = &queue_create,
                            .enabledExtensionCount = uint32_t(extensions.size()),
                            .ppEnabledExtensionNames = extensions.data()};
  NF_VK(vkCreateDevice(physical, &create, nullptr, &handle));
  for (uint32_t i = 0; i < queues; ++i) vkGetDeviceQueue(handle, queue_family, i, &own_queues_[i].handle);
  queue_ = &own_queues_[0];

  push_descriptor_set =
      reinterpret_cast<PFN_vkCmdPushDescriptorSetKHR>(vkGetDeviceProcAddr(handle, "vkCmdPushDescriptorSetKHR"));
  begin_label = reinterpret_cast<PFN_vkCmdBeginDebugUtilsLabelEXT>(
      vkGetInstanceProcAddr(instance, "vkCmdBeginDebugUtilsLabelEXT"));
  end_label =
      reinterpret_cast<PFN_vkCmdEndDebugUtilsLabelEXT>(vkGetInstanceProcAddr(instance, "vkCmdEndDebugUtilsLabelEXT"));
  set_name = reinterpret_cast<PFN_vkSetDebugUtilsObjectNameEXT>(
      vkGetInstanceProcAddr(instance, "vkSetDebugUtilsObjectNameEXT"));

  if (calibrated)
    get_clocks =
        reinterpret_cast<PFN_vkGetCalibratedTimestampsEXT>(vkGetDeviceProcAddr(handle, "vkGetCalibratedTimestampsEXT"));

  VkPhysicalDevicePushDescriptorPropertiesKHR push{
      .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PUSH_DESCRIPTOR_PROPERTIES_KHR};
  VkPhysicalDeviceProperties2 more{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &push};
  vkGetPhysicalDeviceProperties2(physical, &more);
  const uint32_t bits = families[queue_family].timestampValidBits;
  facts = {.software = properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU,
           .fetch_storage = properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU,
           .timestamp_period = properties.limits.timestampPeriod,
           .timestamp_mask = bits == 64 ? ~uint64_t{0} : (uint64_t{1} << bits) - 1,
           .pipeline_statistics = available.pipelineStatisticsQuery == VK_TRUE,
           .calibrated_clock = get_clocks != nullptr,
           .max_push_descriptors = push.maxPushDescriptors,
           .max_image_layers = properties.limits.maxImageArrayLayers,
           .max_image_size = properties.limits.maxImageDimension2D};
}

Device::Device(SecondUser second)
    : DeviceHandles(second.of), owner_(&second.of), queue_(&second.of.own_queues_[queues - 1]) {}

Device::~Device() {
  if (owner_) {
    wait_idle();
    return;
  }
  if (handle) {
    vkDeviceWaitIdle(handle);
    vkDestroyDevice(handle, nullptr);
  }
  if (messenger_)
    reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(instance, "vkDestroyDebugUtilsMessengerEXT"))(instance, messenger_, nullptr);
  vkDestroyInstance(instance, nullptr);
}

std::vector<std::string> Device::take_messages() {
  if (owner_) return owner_->take_messages();
  const std::lock_guard lock(mutex_);
  return std::exchange(messages_, {});
}

void Device::add_message(std::string message) {
  const std::lock_guard lock(mutex_);
  messages_.push_back(std::move(message));
}

VkResult Device::submit(const VkSubmitInfo2& submit, VkFence fence) {
  std::atomic<Loss>& pretended = (owner_ ? owner_ : this)->pretended_;
  if (pretended == Loss::AtPicture && fence) pretended = Loss::Now;  // only the window's pictures have one
  if (pretended == Loss::Now) return VK_ERROR_DEVICE_LOST;
  return submit_although_lost(submit, fence);
}

VkResult Device::submit_although_lost(const VkSubmitInfo2& submit, VkFence fence) {
  const std::lock_guard lock(queue_->mutex);
  return vkQueueSubmit2(queue_->handle, 1, &submit, fence);
}

VkResult Device::present(const VkPresentInfoKHR& present) {
  const std::lock_guard lock(queue_->mutex);
  return vkQueuePresentKHR(queue_->handle, &present);
}

void Device::wait_idle() const {
  const std::lock_guard lock(queue_->mutex);
  const VkResult result = vkQueueWaitIdle(queue_->handle);
  if (result != VK_ERROR_DEVICE_LOST) check(result, "vkQueueWaitIdle", __FILE__, __LINE__);
}

void Device::pretend_lost(Loss loss) {
  (owner_ ? owner_ : this)->pretended_ = loss;
}

std::optional<ClockPair> Device::clocks() const {
  if (!get_clocks) return std::nullopt;
  const VkCalibratedTimestampInfoEXT infos[2] = {
      {.sType = VK_STRUCTURE_TYPE_CALIBRATED_TIMESTAMP_INFO_EXT, .timeDomain = VK_TIME_DOMAIN_DEVICE_EXT},
      {.sType = VK_STRUCTURE_TYPE_CALIBRATED_TIMESTAMP_INFO_EXT, .timeDomain = VK_TIME_DOMAIN_CLOCK_MONOTONIC_EXT}};
  uint64_t times[2] = {}, deviation = 0;
  NF_VK(get_clocks(handle, 2, infos, times, &deviation));
  return ClockPair{double(times[0]) * double(facts.timestamp_period), double(times[1])};
}

void Device::name_object(VkObjectType type, uint64_t object, const std::string& name) const {
  if (!validation && !renderdoc_loaded()) return;  // names only serve messages and captures
  VkDebugUtilsObjectNameInfoEXT info_ext{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT,
                                         .objectType = type,
                                         .objectHandle = object,
                                         .pObjectName = name.c_str()};
  set_name(handle, &info_ext);
}

std::vector<DeviceInfo> list_devices() {
  VkInstance instance = create_instance(false);
  const auto physicals = enumerate(instance);
  std::vector<DeviceInfo> infos;
  for (uint32_t i = 0; i < physicals.size(); ++i) infos.push_back(describe(physicals[i], i));
  vkDestroyInstance(instance, nullptr);
  return infos;
}

}  // namespace nf::gpu
