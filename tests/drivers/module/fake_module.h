/* The table of the modules in fake_module.c. */
#ifndef TESTS_DRIVERS_MODULE_FAKE_MODULE_H
#define TESTS_DRIVERS_MODULE_FAKE_MODULE_H

#include "drivers/base/module.h"

enum { FAKE_ANSWER = 4711 };

struct fake_module {
    struct iso_module module;
    int (*answer)(void);
    int (*more)(void);
};

#endif
