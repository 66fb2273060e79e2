/// Included before nanoflann (wasm/CMakeLists.txt), which throws, and prints, where memory runs out. In WebAssembly
/// nothing catches that: it ends the call as `abort` does, and would bring 3.4 KB of the C++ runtime along, 1.8 KB
/// gzipped.
#pragma once

#define _LIBCPP_NO_EXCEPTIONS

// All that nanoflann and its includer include, before `throw` is something else.
#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <istream>
#include <limits>
#include <new>
#include <ostream>
#include <stdexcept>
#include <type_traits>
#include <unordered_set>
#include <utility>
#include <vector>

#define throw std::abort(), (void)
#define fprintf(...) 0
