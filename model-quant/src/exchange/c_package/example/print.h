/* Output of the example, of which host and target have their own. */
#ifndef PRINT_H
#define PRINT_H

#include <stdint.h>

void print_text(const char *text);
void print_integer(int32_t number);

#endif
