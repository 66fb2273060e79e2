/// Prints what the reader of glTF makes of files, a line of JSON each: tests/package/readers.test.ts compares it.
///
///     cagecast_read_gltf FILE …

#include <cstdio>

#include "gltf/gltf.hpp"

namespace {

template <typename T>
void print(const char* name, const std::vector<T>& values) {
  std::printf("\"%s\":[", name);
  for (std::size_t i = 0; i < values.size(); ++i)
    std::printf("%s%.9g", i > 0 ? "," : "", static_cast<double>(values[i]));
  std::printf("],");
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    cagecast::gltf::Model model;
    const cagecast::gltf::Result result = cagecast::gltf::read(argv[i], model);
    std::printf("{");
    print("positions", model.positions);
    print("indices", model.indices);
    print("uvs", model.uvs);
    print("groups", model.groups);
    std::printf("\"error\":\"%s\"}\n", result.error.c_str());
  }
}
