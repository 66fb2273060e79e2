/// Embind names types that nothing is bound to by `sprintf("%p", …)`, for messages about calls that this package never
/// makes. For that alone all of printf would come along: 5 KB of WebAssembly, 2 KB gzipped. The linker puts these in its
/// place (`--wrap`); which of them is called depends on the compiler.

extern "C" {
int __wrap_sprintf(char* out, const char* format, ...);
int __wrap_siprintf(char* out, const char* format, ...);
int __wrap___small_sprintf(char* out, const char* format, ...);

int __wrap_sprintf(char* out, const char*, ...) {
  *out = '\0';
  return 0;
}
int __wrap_siprintf(char* out, const char*, ...) {
  *out = '\0';
  return 0;
}
int __wrap___small_sprintf(char* out, const char*, ...) {
  *out = '\0';
  return 0;
}
}
