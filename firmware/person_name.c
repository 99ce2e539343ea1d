#include "firmware/person_name.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "firmware/utf8.h"

static bool is_control(uint32_t c)
{
    return c < 0x20 || (c >= 0x7f && c < 0xa0) || (c >= 0x2028 && c <= 0x202e) ||
           (c >= 0x2066 && c <= 0x2069) || c == 0x200e || c == 0x200f || c == 0xfeff;
}

static bool is_blank(uint32_t c)
{
    return c == ' ' || c == 0xa0 || (c >= 0x2000 && c <= 0x200a) || c == 0x3000;
}

const char *iso_person_name_flaw(const char *name)
{
    uint32_t c = 0, last = 0;
    int n = 0;
    for (; *name; n++, last = c) {
        const int length = iso_utf8_decode(name, &c);
        if (!length) {
            return "the name is not UTF-8";
        }
        if (is_control(c)) {
            return "the name holds a control character";
        }
        if (n == 0 && is_blank(c)) {
            return "the name begins with a blank";
        }
        if (n == ISO_PERSON_NAME_CHARACTERS) {
            return "the name is longer than 64 characters";
        }
        name += length;
    }
    if (n == 0) {
        return "the name is empty";
    }
    return is_blank(last) ? "the name ends with a blank" : NULL;
}
