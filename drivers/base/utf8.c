#include "drivers/base/utf8.h"

/* The length of a sequence by its first byte; 0 if no sequence begins with this byte. */
static int sequence_length(unsigned char first)
{
    if (first < 0x80) {
        return 1;
    }
    if (first < 0xc2) {
        /* A continuation byte, or the beginning of an overlong sequence. */
        return 0;
    }
    if (first < 0xe0) {
        return 2;
    }
    if (first < 0xf0) {
        return 3;
    }
    return first < 0xf5 ? 4 : 0;
}

int iso_utf8_decode(const char *text, uint32_t *character)
{
    static const uint32_t smallest[] = {0, 0, 0x80, 0x800, 0x10000};
    const unsigned char *bytes = (const unsigned char *)text;
    const int length = sequence_length(bytes[0]);
    if (length <= 1) {
        if (length) {
            *character = bytes[0];
        }
        return length;
    }
    uint32_t c = bytes[0] & (0x7fu >> length);
    for (int i = 1; i < length; i++) {
        if ((bytes[i] & 0xc0) != 0x80) {
            return 0;
        }
        c = c << 6 | (bytes[i] & 0x3fu);
    }
    if (c < smallest[length] || (c >= 0xd800 && c < 0xe000) || c > 0x10ffff) {
        return 0;
    }
    *character = c;
    return length;
}

bool iso_utf8_is_valid(const char *text)
{
    uint32_t character;
    while (*text) {
        const int n = iso_utf8_decode(text, &character);
        if (n == 0) {
            return false;
        }
        text += n;
    }
    return true;
}
