/* cmocka.h, and the headers that it needs before it. */
#ifndef TESTS_FIRMWARE_RIGS_CMOCKA_HEADERS_H
#define TESTS_FIRMWARE_RIGS_CMOCKA_HEADERS_H

// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on

#endif
