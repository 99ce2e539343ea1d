#include <stdarg.h>
#include <stdio.h>

#include "enroll/policy_reader/reader_input.h"

json_t *reader_refuse(struct reader_line *line, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(line->text, sizeof line->text, format, arguments);
    va_end(arguments);
    for (char *c = line->text; *c; c++) {
        *c = (unsigned char)*c < 0x20 || *c == 0x7f ? '?' : *c;
    }
    return NULL;
}

json_t *reader_json(const char *text, size_t size, struct reader_line *line)
{
    json_error_t error;
    json_t *document = json_loadb(text, size, JSON_REJECT_DUPLICATES, &error);
    if (!document) {
        return reader_refuse(line, "line %d, column %d: %s", error.line, error.column, error.text);
    }
    if (!json_is_object(document)) {
        json_decref(document);
        return reader_refuse(line, "the document is not an object");
    }
    return document;
}
