/// A QEMU plugin that prints, when the program ends, how many instructions it executed: one line on stderr,
/// "instructions 123". Debian packages no header for plugins, so what is used of QEMU's plugin interface (version 1,
/// QEMU 4.2 to 8; https://www.qemu.org/docs/master/devel/tcg-plugins.html) is declared here.

#include <cinttypes>
#include <cstddef>
#include <cstdint>
#include <cstdio>

extern "C" {

struct qemu_plugin_tb;
enum qemu_plugin_cb_flags { QEMU_PLUGIN_CB_NO_REGS };

void qemu_plugin_register_vcpu_tb_trans_cb(std::uint64_t id, void (*callback)(std::uint64_t id, qemu_plugin_tb* block));
void qemu_plugin_register_vcpu_tb_exec_cb(qemu_plugin_tb* block, void (*callback)(unsigned cpu, void* data),
                                          qemu_plugin_cb_flags flags, void* data);
void qemu_plugin_register_atexit_cb(std::uint64_t id, void (*callback)(std::uint64_t id, void* data), void* data);
std::size_t qemu_plugin_tb_n_insns(const qemu_plugin_tb* block);

__attribute__((visibility("default"))) int qemu_plugin_version = 1;

static std::uint64_t executed = 0;

__attribute__((visibility("default"))) int qemu_plugin_install(std::uint64_t id, const void*, int, char**) {
  // A block of instructions is executed as a whole; its length is handed to the callback in place of a pointer.
  qemu_plugin_register_vcpu_tb_trans_cb(id, [](std::uint64_t, qemu_plugin_tb* block) {
    qemu_plugin_register_vcpu_tb_exec_cb(
        block, [](unsigned, void* length) { executed += reinterpret_cast<std::uintptr_t>(length); },
        QEMU_PLUGIN_CB_NO_REGS, reinterpret_cast<void*>(qemu_plugin_tb_n_insns(block)));
  });
  qemu_plugin_register_atexit_cb(
      id, [](std::uint64_t, void*) { std::fprintf(stderr, "instructions %" PRIu64 "\n", executed); }, nullptr);
  return 0;
}
}
