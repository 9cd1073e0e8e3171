/* Start of a Cortex-M4F: vectors, FPU, memory, main. The result of main goes to the debugger or
 * emulator (ARM semihosting, SYS_EXIT). */
#include <stdint.h>

extern uint32_t data_start[], data_end[], data_load[], bss_start[], bss_end[], stack_top[];

int main(void);
void reset(void);

static void leave(uint32_t reason)
{
    register uint32_t operation __asm__("r0") = 0x18;
    register uint32_t argument __asm__("r1") = reason;
    for (;;) {
        __asm__ volatile("bkpt 0xAB" : "+r"(operation) : "r"(argument) : "memory");
    }
}

static void fault(void)
{
    leave(0x20024); /* ADP_Stopped_InternalError */
}

void reset(void)
{
    /* The library uses the FPU: full access to coprocessors 10 and 11 in CPACR. */
    *(volatile uint32_t *)0xE000ED88 |= 0xFu << 20;
    __asm__ volatile("dsb\n isb" ::: "memory");
    for (uint32_t *to = data_start, *from = data_load; to < data_end; to++, from++) {
        *to = *from;
    }
    for (uint32_t *to = bss_start; to < bss_end; to++) {
        *to = 0;
    }
    leave(main() == 0 ? 0x20026 : 0x20024); /* ADP_Stopped_ApplicationExit, else an error */
}

/* Initial stack pointer, reset, then the faults of the core. */
__attribute__((section(".vectors"), used)) static const void *const vectors[16] = {
    stack_top, (const void *)reset, (const void *)fault, (const void *)fault,
    (const void *)fault, (const void *)fault, (const void *)fault,
};
