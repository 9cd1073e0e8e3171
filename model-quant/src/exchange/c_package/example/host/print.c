#include "../print.h"

#include <stdio.h>

void print_text(const char *text)
{
    fputs(text, stdout);
}

void print_integer(int32_t number)
{
    printf("%ld", (long)number);
}
