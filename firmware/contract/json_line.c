#include "firmware/contract/json_line.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#include "drivers/base/utf8.h"

__attribute__((format(printf, 2, 3))) static void append(struct iso_json_line *line,
                                                         const char *format, ...)
{
    const size_t room = sizeof line->text - line->length;
    va_list arguments;
    va_start(arguments, format);
    const int length = vsnprintf(line->text + line->length, room, format, arguments);
    va_end(arguments);
    if (length < 0 || (size_t)length >= room) {
        line->text[line->length] = '\0';
        line->overflow = true;
        return;
    }
    line->length += (size_t)length;
}

static void append_key(struct iso_json_line *line, const char *key)
{
    append(line, "%s\"%s\":", line->length > 1 ? "," : "", key);
}

void iso_json_line_begin(struct iso_json_line *line)
{
    line->length = 0;
    line->overflow = false;
    append(line, "{");
}

void iso_json_line_integer(struct iso_json_line *line, const char *key, int64_t value)
{
    append_key(line, key);
    append(line, "%" PRId64, value);
}

void iso_json_line_number(struct iso_json_line *line, const char *key, double value)
{
    append_key(line, key);
    if (isfinite(value)) {
        append(line, "%.6g", value);
    } else {
        append(line, "null");
    }
}

void iso_json_line_string(struct iso_json_line *line, const char *key, const char *value)
{
    append_key(line, key);
    append(line, "\"");
    while (*value) {
        uint32_t c = 0;
        const int length = iso_utf8_decode(value, &c);
        if (length == 0) {
            append(line, "\\ufffd");
        } else if (c == '"' || c == '\\') {
            append(line, "\\%c", (int)c);
        } else if (c < 0x20 || c == 0x7f) {
            append(line, "\\u%04x", (unsigned)c);
        } else {
            append(line, "%.*s", length, value);
        }
        value += length ? length : 1;
    }
    append(line, "\"");
}

size_t iso_json_line_end(struct iso_json_line *line)
{
    append(line, "}\n");
    return line->overflow ? 0 : line->length;
}
