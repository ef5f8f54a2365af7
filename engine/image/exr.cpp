// EXR through OpenEXR: single-part scan-line files, ZIP compressed. Encoding goes to memory, so that the file system is
// met in one place only.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <ImfVersion.h>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <half.h>
#include <mutex>
#include <thread>

#include "core/error.h"
#include "image/file.h"
#include "image/image.h"

namespace nf::image {
namespace {

constexpr int max_side = 65536;

class MemoryWriter : public Imf::OStream {
 public:
  MemoryWriter() : OStream("memory") {}
  void write(const char* from, int count) override {
    bytes.resize(std::max(bytes.size(), position_ + size_t(count)));
    std::memcpy(bytes.data() + position_, from, size_t(count));
    position_ += size_t(count);
  }
  uint64_t tellp() override { return position_; }
  void seekp(uint64_t position) override { position_ = position; }

  std::vector<uint8_t> bytes;

 private:
  size_t position_ = 0;
};

class MemoryReader : public Imf::IStream {
 public:
  explicit MemoryReader(std::span<const uint8_t> bytes) : IStream("memory"), bytes_(bytes) {}
  bool read(char* to, int count) override {
    if (count < 0 || position_ > bytes_.size() || size_t(count) > bytes_.size() - position_)
      throw std::runtime_error("the file is truncated");
    std::memcpy(to, bytes_.data() + position_, size_t(count));
    position_ += size_t(count);
    return position_ < bytes_.size();
  }
  uint64_t tellg() override { return position_; }
  void seekg(uint64_t position) override { position_ = position; }

 private:
  std::span<const uint8_t> bytes_;
  uint64_t position_ = 0;
};

void set_up_library() {
  static std::once_flag once;
  std::call_once(once, [] {
    Imf::setGlobalThreadCount(int(std::clamp(std::thread::hardware_concurrency(), 1u, 8u)));
    Imf::Header::setMaxImageSize(max_side, max_side);
    Imf::Header::setMaxTileSize(max_side, max_side);
  });
}

std::string full_name(const std::string& layer, char channel) {
  return layer.empty() ? std::string(1, channel) : layer + "." + channel;
}

half saturated_half(float value) {
  return half(std::isnan(value) ? value : std::clamp(value, -65504.0f, 65504.0f));
}

// The components of one layer, wherever and as whatever they lie.
void insert_slices(Imf::FrameBuffer& frame, const Layer& layer, Imf::PixelType type, char* base, size_t component,
                   uint32_t channels) {
  const size_t pixel = component * channels;
  for (size_t c = 0; c < layer.channels.size(); ++c) {
    frame.insert(full_name(layer.name, layer.channels[c]),
                 Imf::Slice(type, base + c * component, pixel, pixel * layer.image.width));
  }
}

void check_layers(std::span<const Layer> layers) {
  NF_CHECK(!layers.empty(), "an EXR file needs a layer");
  const Image& first = layers[0].image;
  NF_CHECK(first.width > 0 && first.height > 0 && first.width <= max_side && first.height <= max_side, "{}x{}",
           first.width, first.height);
  for (const Layer& layer : layers) {
    const Image& image = layer.image;
    NF_CHECK(image.width == first.width && image.height == first.height, "layer '{}' is {}x{}, layer '{}' {}x{}",
             layer.name, image.width, image.height, layers[0].name, first.width, first.height);
    NF_CHECK(image.channels == layer.channels.size() && image.channels > 0, "layer '{}': {} channels named '{}'",
             layer.name, image.channels, layer.channels);
    NF_CHECK(image.pixels.size() == size_t(image.width) * image.height * image.channels, "layer '{}': {} values",
             layer.name, image.pixels.size());
  }
}

std::vector<uint8_t> encode_exr(std::span<const Layer> layers, const std::map<std::string, std::string>& attributes,
                                Precision precision) {
  const Image& first = layers[0].image;
  const Imf::PixelType type = precision == Precision::Half ? Imf::HALF : Imf::FLOAT;
  Imf::Header header(int(first.width), int(first.height));
  header.compression() = Imf::ZIP_COMPRESSION;
  header.zipCompressionLevel() = 4;  // half the time of the default 6 for a few per cent of size
  for (const auto& [name, text] : attributes) header.insert(name, Imf::StringAttribute(text));

  Imf::FrameBuffer frame;
  std::vector<std::vector<half>> halves(layers.size());
  for (size_t i = 0; i < layers.size(); ++i) {
    const Layer& layer = layers[i];
    for (char channel : layer.channels) {
      const std::string name = full_name(layer.name, channel);
      NF_CHECK(!header.channels().findChannel(name), "the EXR channel '{}' is given twice", name);
      header.channels().insert(name, Imf::Channel(type));
    }
    if (precision == Precision::Half) {
      halves[i].resize(layer.image.pixels.size());
      std::ranges::transform(layer.image.pixels, halves[i].begin(), saturated_half);
      insert_slices(frame, layer, type, reinterpret_cast<char*>(halves[i].data()), sizeof(half), layer.image.channels);
    } else {
      // The library's slices are not const, but an OutputFile only reads them.
      char* base = const_cast<char*>(reinterpret_cast<const char*>(layer.image.pixels.data()));
      insert_slices(frame, layer, type, base, sizeof(float), layer.image.channels);
    }
  }

  MemoryWriter writer;
  {
    Imf::OutputFile file(writer, header);
    file.setFrameBuffer(frame);
    file.writePixels(int(first.height));
  }  // the destructor completes the table of offsets
  return std::move(writer.bytes);
}

// R, G, B, A first, the rest by letter.
int channel_rank(char channel) {
  const size_t colour = std::string_view("RGBA").find(channel);
  return colour == std::string_view::npos ? 4 + int(static_cast<unsigned char>(channel)) : int(colour);
}

// "name.X" is component X of layer "name", "X" one of the default layer. A longer last part cannot be a letter of
// Layer::channels, so such a channel becomes a layer of its own with the one component "V".
struct Source {
  std::string layer, channel_in_file;
  char letter = 'V';
};
Source source_of(const std::string& channel) {
  const size_t dot = channel.rfind('.');
  const size_t start = dot == std::string::npos ? 0 : dot + 1;
  if (channel.size() - start != 1) return {channel, channel, 'V'};
  return {channel.substr(0, start == 0 ? 0 : dot), channel, channel[start]};
}

void refuse_unsupported(const Imf::Header& header, size_t file_size) {
  const Imath::Box2i window = header.dataWindow();
  const uint64_t pixels = uint64_t(window.max.x - window.min.x + 1) * uint64_t(window.max.y - window.min.y + 1);
  uint64_t raw_bytes = 0;
  for (auto i = header.channels().begin(); i != header.channels().end(); ++i) {
    if (i.channel().xSampling != 1 || i.channel().ySampling != 1)
      throw std::runtime_error(fmt::format("the channel '{}' is subsampled", i.name()));
    raw_bytes += pixels * (i.channel().type == Imf::HALF ? 2 : 4);
  }
  if (raw_bytes == 0) throw std::runtime_error("it has no pixels");
  // Found out before memory is spent: deflate's limit is 1032 to 1; the other methods have none that is known.
  const Imf::Compression method = header.compression();
  const bool bounded = method == Imf::NO_COMPRESSION || method == Imf::RLE_COMPRESSION ||
                       method == Imf::ZIPS_COMPRESSION || method == Imf::ZIP_COMPRESSION;
  if (raw_bytes > uint64_t(file_size) * (bounded ? 1040 : 100'000)) throw std::runtime_error("the file is truncated");
}

ExrFile decode_exr(std::span<const uint8_t> bytes) {
  MemoryReader reader(bytes);
  Imf::InputFile file(reader);
  const Imf::Header& header = file.header();
  refuse_unsupported(header, bytes.size());

  std::map<std::string, std::vector<Source>> layers;  // sorted, "" first
  for (auto i = header.channels().begin(); i != header.channels().end(); ++i) {
    const Source source = source_of(i.name());
    layers[source.layer].push_back(source);
  }
  ExrFile result;
  const Imath::Box2i window = header.dataWindow();
  Imf::FrameBuffer frame;
  for (auto& [name, sources] : layers) {
    std::ranges::stable_sort(sources, {}, [](const Source& source) { return channel_rank(source.letter); });
    Layer& layer = result.layers.emplace_back();
    layer.name = name;
    layer.image.width = uint32_t(window.max.x - window.min.x + 1);
    layer.image.height = uint32_t(window.max.y - window.min.y + 1);
    layer.image.channels = uint32_t(sources.size());
    layer.image.pixels.resize(size_t(layer.image.width) * layer.image.height * sources.size());
    const size_t pixel = sizeof(float) * sources.size();
    for (size_t c = 0; c < sources.size(); ++c) {
      layer.channels += sources[c].letter;
      frame.insert(sources[c].channel_in_file, Imf::Slice::Make(Imf::FLOAT, layer.image.pixels.data() + c, window,
                                                                pixel, pixel * layer.image.width));
    }
  }
  file.setFrameBuffer(frame);
  file.readPixels(window.min.y, window.max.y);

  for (auto i = header.begin(); i != header.end(); ++i) {
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&i.attribute()))
      result.header[i.name()] = text->value();
  }
  return result;
}

}  // namespace

void write_exr(const std::filesystem::path& path, std::span<const Layer> layers,
               const std::map<std::string, std::string>& header, Precision precision) {
  check_layers(layers);
  set_up_library();
  std::vector<uint8_t> bytes;
  try {
    bytes = encode_exr(layers, header, precision);
  } catch (const std::exception& e) {
    fail(Exit::Output, "cannot write '{}': {}; check the names of layers and header entries", path.string(), e.what());
  }
  write_file(path, bytes);
}

ExrFile read_exr(const std::filesystem::path& path) {
  const std::vector<uint8_t> bytes = read_file(path);
  set_up_library();
  std::string why;
  if (bytes.size() < 8 || !Imf::isImfMagic(reinterpret_cast<const char*>(bytes.data()))) {
    fail(Exit::Input, "cannot read '{}': it is not an EXR file; check the path", path.string());
  }
  const int version = bytes[4] | bytes[5] << 8 | bytes[6] << 16 | bytes[7] << 24;
  if (Imf::isNonImage(version) || Imf::isMultiPart(version)) {
    fail(Exit::Input, "cannot read '{}': it is deep or in several parts; save it as one flat part", path.string());
  }
  try {
    return decode_exr(bytes);
  } catch (const std::exception& e) {
    why = e.what();
  }
  fail(Exit::Input, "cannot read '{}': {}; make the file again", path.string(), why);
}

}  // namespace nf::image
