#include "model.hpp"

#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <iterator>

#ifdef CAGECAST_BENCH_GLTF
#include "gltf/gltf.hpp"
#endif

namespace cagecast::bench {
namespace {

static_assert(std::endian::native == std::endian::little, "scene files are read as they lie in memory");

/// Takes values off the front of a file's bytes.
class Reader {
 public:
  explicit Reader(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    good_ = file.good();
    bytes_.assign(std::istreambuf_iterator<char>(file), {});
  }
  template <typename T>
  void take(T* values, std::size_t count) {
    good_ = good_ && count <= (bytes_.size() - at_) / sizeof(T);
    if (!good_ || count == 0) return;
    std::memcpy(values, bytes_.data() + at_, count * sizeof(T));
    at_ += count * sizeof(T);
  }
  template <typename T>
  void take(std::vector<T>& values, std::size_t count) {
    good_ = good_ && count <= (bytes_.size() - at_) / sizeof(T);
    if (!good_) return;
    values.resize(count);
    take(values.data(), count);
  }
  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] bool atEnd() const { return at_ == bytes_.size(); }

 private:
  std::vector<char> bytes_;
  std::size_t at_ = 0;
  bool good_ = false;
};

void takeMesh(Reader& in, Mesh& mesh) {
  std::uint32_t counts[2] = {};
  std::uint8_t flags[4] = {};
  in.take(counts, 2);
  in.take(flags, 4);
  in.take(mesh.positions, std::size_t{3} * counts[0]);
  in.take(mesh.indices, counts[1]);
  if (flags[0] != 0) in.take(mesh.uvs, std::size_t{2} * counts[0]);
  if (flags[1] != 0) in.take(mesh.groups, counts[0]);
}

std::string readScene(const std::string& path, Model& out) {
  Reader in(path);
  if (!in.good()) return path + ": cannot be read";
  std::array<char, 8> magic{};
  in.take(magic.data(), magic.size());
  if (std::memcmp(magic.data(), "CAGESCN1", magic.size()) != 0)
    return path + ": is not a scene file (give two files, target and cage, for glTF)";
  takeMesh(in, out.cage);
  takeMesh(in, out.target);
  return in.good() && in.atEnd() ? "" : path + ": is cut off, or longer than it says";
}

#ifdef CAGECAST_BENCH_GLTF
std::string readGltf(const std::string& path, Mesh& out) {
  gltf::Model model;
  if (gltf::Result result = gltf::read(path, model); !result.ok()) return result.error;
  out = {std::move(model.positions), std::move(model.uvs), std::move(model.indices), std::move(model.groups)};
  return "";
}
#else
std::string readGltf(const std::string& path, Mesh&) {
  return path + ": this benchmark was built without tinygltf, and reads scene files only";
}
#endif

}  // namespace

std::string readModel(const std::vector<std::string>& paths, Model& out) {
  std::string error = paths.size() == 1 ? readScene(paths[0], out) : readGltf(paths[0], out.target);
  if (error.empty() && paths.size() == 2) error = readGltf(paths[1], out.cage);
  for (Mesh* mesh : {&out.cage, &out.target}) mesh->positions.reserve(mesh->positions.size() + 1);
  return error;
}

std::string writeScene(const std::string& path, const Model& model) {
  std::ofstream file(path, std::ios::binary);
  const auto put = [&]<typename T>(std::span<const T> values) {
    file.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size_bytes()));
  };
  put(std::span<const char>("CAGESCN1", 8));
  for (const Mesh* mesh : {&model.cage, &model.target}) {
    const std::uint32_t counts[] = {static_cast<std::uint32_t>(mesh->positions.size() / 3),
                                    static_cast<std::uint32_t>(mesh->indices.size())};
    const std::uint8_t flags[] = {!mesh->uvs.empty(), !mesh->groups.empty(), 0, 0};
    put(std::span<const std::uint32_t>(counts));
    put(std::span<const std::uint8_t>(flags));
    put(std::span<const float>(mesh->positions));
    put(std::span<const std::uint32_t>(mesh->indices));
    put(std::span<const float>(mesh->uvs));
    put(std::span<const std::uint32_t>(mesh->groups));
  }
  file.close();
  return file.good() ? "" : path + ": cannot be written";
}

}  // namespace cagecast::bench
