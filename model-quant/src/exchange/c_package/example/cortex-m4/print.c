/* Output through a debugger or emulator: ARM semihosting. Without one its instruction stops the
 * processor. */
#include "../print.h"

enum { SYS_OPEN = 0x01, SYS_WRITE = 0x05 };

static uint32_t semihosting(uint32_t number, const void *arguments)
{
    register uint32_t operation __asm__("r0") = number;
    register const void *argument __asm__("r1") = arguments;
    __asm__ volatile("bkpt 0xAB" : "+r"(operation) : "r"(argument) : "memory");
    return operation;
}

void print_text(const char *text)
{
    static const char terminal[] = ":tt";
    static uint32_t handle;
    uint32_t length = 0;
    if (handle == 0) {
        /* Mode 4 is "w": standard output. */
        const uint32_t arguments[3] = {(uint32_t)terminal, 4, sizeof terminal - 1};
        handle = semihosting(SYS_OPEN, arguments);
    }
    while (text[length] != '\0') {
        length++;
    }
    {
        const uint32_t arguments[3] = {handle, (uint32_t)text, length};
        (void)semihosting(SYS_WRITE, arguments);
    }
}

void print_integer(int32_t number)
{
    char text[12];
    char *start = text + sizeof text - 1;
    uint32_t rest = number < 0 ? 0u - (uint32_t)number : (uint32_t)number;
    *start = '\0';
    do {
        *--start = (char)('0' + rest % 10);
        rest /= 10;
    } while (rest != 0);
    if (number < 0) {
        *--start = '-';
    }
    print_text(start);
}
