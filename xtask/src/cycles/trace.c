/* Plugin of the emulator that records every executed instruction and every data address between two
   marks. `cargo xtask cycles` compiles it and loads it.

   Arguments:
     out=PREFIX     the records are written to PREFIX-PID.trace
     reads=N        a section begins after a read of SysTick's counter and ends with the Nth read
     entry=ADDRESS  a section is the interrupt handler at this address, up to its return
     min=N          sections of fewer instructions are left out and not counted
     keep=A-B/N     of the sections from A to B, B excluded, every Nth is written; may be repeated
     longest=1      each section that executes more instructions than all before it is written, too
     exit=1         the emulator ends after the last section to keep

   Record, little-endian words of 32 bits: index of the section, its instructions, number of words,
   the words. A word with bit 0 set is an instruction at that address less 1. Any other word is an
   access to data, followed by its address: bit 1 is set for a store, bits 2 and 3 are the logarithm
   of its size in bytes.

   The declarations are those of version 1 of the plugin interface (qemu-plugin.h of QEMU 7.2). */

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef uint64_t qemu_plugin_id_t;
typedef uint32_t qemu_plugin_meminfo_t;
struct qemu_plugin_tb;
struct qemu_plugin_insn;
enum { QEMU_PLUGIN_CB_NO_REGS = 0, QEMU_PLUGIN_MEM_RW = 3 };

void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t id,
                                           void (*callback)(qemu_plugin_id_t, struct qemu_plugin_tb *));
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *tb);
struct qemu_plugin_insn *qemu_plugin_tb_get_insn(const struct qemu_plugin_tb *tb, size_t index);
uint64_t qemu_plugin_insn_vaddr(const struct qemu_plugin_insn *insn);
void qemu_plugin_register_vcpu_insn_exec_cb(struct qemu_plugin_insn *insn,
                                            void (*callback)(unsigned int, void *), int flags, void *data);
void qemu_plugin_register_vcpu_mem_cb(struct qemu_plugin_insn *insn,
                                      void (*callback)(unsigned int, qemu_plugin_meminfo_t, uint64_t, void *),
                                      int flags, int accesses, void *data);
unsigned int qemu_plugin_mem_size_shift(qemu_plugin_meminfo_t info);
bool qemu_plugin_mem_is_store(qemu_plugin_meminfo_t info);

extern const int qemu_plugin_version;
const int qemu_plugin_version = 1;

/* SysTick's current value. */
static const uint32_t COUNTER = 0xE000E018;

static uint32_t reads_per_section;
static uint32_t handler_entry = 1;
static uint32_t min_instructions;
static bool keeps_longest, exits;
static struct {
    uint32_t from, to, stride;
} ranges[16];
static size_t range_count;
static uint32_t end;
static FILE *out;

static bool is_open;
static uint32_t reads, sections, instructions, max_instructions;
/* Stack address that the handler's return address is stored at. */
static uint32_t return_slot;
static uint32_t *words;
static size_t count, capacity;

static void push(uint32_t word)
{
    if (count == capacity) {
        capacity = capacity ? 2 * capacity : 65536;
        words = realloc(words, capacity * sizeof *words);
        if (!words) {
            fprintf(stderr, "trace: no memory\n");
            abort();
        }
    }
    words[count++] = word;
}

static void open_section(void)
{
    is_open = true;
    count = 0;
    instructions = 0;
    return_slot = 0;
}

static bool is_kept(void)
{
    for (size_t at = 0; at < range_count; at++) {
        if (sections >= ranges[at].from && sections < ranges[at].to &&
            (sections - ranges[at].from) % ranges[at].stride == 0) {
            return true;
        }
    }
    return keeps_longest && instructions > max_instructions;
}

static void close_section(void)
{
    is_open = false;
    if (instructions < min_instructions || sections >= end) {
        return;
    }
    if (is_kept()) {
        uint32_t header[3] = {sections, instructions, (uint32_t)count};
        if (fwrite(header, sizeof header, 1, out) != 1 || fwrite(words, sizeof *words, count, out) != count ||
            fflush(out)) {
            fprintf(stderr, "trace: the file cannot be written\n");
            abort();
        }
    }
    if (instructions > max_instructions) {
        max_instructions = instructions;
    }
    if (++sections == end && exits) {
        _exit(0);
    }
}

static void execute(unsigned int cpu, void *data)
{
    uint32_t address = (uint32_t)(uintptr_t)data;
    (void)cpu;
    if (address == handler_entry && !is_open) {
        open_section();
    }
    if (is_open) {
        push(address | 1);
        instructions++;
    }
}

static void access_data(unsigned int cpu, qemu_plugin_meminfo_t info, uint64_t long_address, void *data)
{
    uint32_t address = (uint32_t)long_address;
    bool is_store = qemu_plugin_mem_is_store(info);
    (void)cpu;
    (void)data;
    if (is_open) {
        push((is_store ? 2 : 0) | qemu_plugin_mem_size_shift(info) << 2);
        push(address);
    }
    if (reads_per_section && !is_store && address == COUNTER) {
        if (!is_open) {
            reads = 1;
            open_section();
        } else if (++reads == reads_per_section) {
            close_section();
        }
    }
    /* The handler begins by storing its return address, as the last and highest of a PUSH. */
    if (!reads_per_section && is_open) {
        if (instructions == 1 && is_store) {
            return_slot = address;
        } else if (!is_store && address == return_slot) {
            close_section();
        }
    }
}

static void translate(qemu_plugin_id_t id, struct qemu_plugin_tb *tb)
{
    (void)id;
    for (size_t at = 0; at < qemu_plugin_tb_n_insns(tb); at++) {
        struct qemu_plugin_insn *insn = qemu_plugin_tb_get_insn(tb, at);
        void *address = (void *)(uintptr_t)qemu_plugin_insn_vaddr(insn);
        qemu_plugin_register_vcpu_insn_exec_cb(insn, execute, QEMU_PLUGIN_CB_NO_REGS, address);
        qemu_plugin_register_vcpu_mem_cb(insn, access_data, QEMU_PLUGIN_CB_NO_REGS, QEMU_PLUGIN_MEM_RW, NULL);
    }
}

static bool add_range(const char *text)
{
    unsigned from, to, stride;
    if (range_count == sizeof ranges / sizeof *ranges || sscanf(text, "%u-%u/%u", &from, &to, &stride) != 3 ||
        !stride) {
        return false;
    }
    ranges[range_count].from = from;
    ranges[range_count].to = to;
    ranges[range_count++].stride = stride;
    end = to > end ? to : end;
    return true;
}

int qemu_plugin_install(qemu_plugin_id_t id, const void *info, int argc, char **argv)
{
    char path[4096];
    (void)info;
    for (int at = 0; at < argc; at++) {
        char *value = strchr(argv[at], '=');
        if (!value) {
            return 1;
        }
        value++;
        if (!strncmp(argv[at], "out=", 4)) {
            int length = snprintf(path, sizeof path, "%s-%ld.trace", value, (long)getpid());
            if (length < 0 || (size_t)length >= sizeof path) {
                return 1;
            }
            out = fopen(path, "wb");
        } else if (!strncmp(argv[at], "reads=", 6)) {
            reads_per_section = (uint32_t)strtoul(value, NULL, 0);
        } else if (!strncmp(argv[at], "entry=", 6)) {
            handler_entry = (uint32_t)strtoul(value, NULL, 0);
        } else if (!strncmp(argv[at], "min=", 4)) {
            min_instructions = (uint32_t)strtoul(value, NULL, 0);
        } else if (!strncmp(argv[at], "longest=", 8)) {
            keeps_longest = strtoul(value, NULL, 0) != 0;
        } else if (!strncmp(argv[at], "exit=", 5)) {
            exits = strtoul(value, NULL, 0) != 0;
        } else if (!strncmp(argv[at], "keep=", 5) && add_range(value)) {
            continue;
        } else {
            return 1;
        }
    }
    if (!out) {
        fprintf(stderr, "trace: no file to write to\n");
        return 1;
    }
    qemu_plugin_register_vcpu_tb_trans_cb(id, translate);
    return 0;
}
