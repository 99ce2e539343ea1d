/* Compares doubles as doubles: cmocka's assert_float_equal rounds both sides to float first. */
#ifndef TESTS_SUPPORT_NEAR_H
#define TESTS_SUPPORT_NEAR_H

#include <math.h>

/* Include after cmocka.h. */
#define assert_near(value, expected, tolerance)                                    \
    do {                                                                           \
        double near_value = (value), near_expected = (expected);                   \
        if (!(fabs(near_value - near_expected) <= (tolerance))) {                  \
            fail_msg("%s is %.12g, not %.12g", #value, near_value, near_expected); \
        }                                                                          \
    } while (0)

#endif
