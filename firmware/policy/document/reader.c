#include "firmware/policy/document/reader.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "core/base/fault.h"

enum { QUOTED = 64 }; /* bytes of a text that a line quotes */

int iso__quoted(const char *text)
{
    size_t size = text ? strlen(text) : 0;
    if (size > QUOTED) {
        size = QUOTED;
        while (size > 0 && ((unsigned char)text[size] & 0xc0) == 0x80) {
            size--;
        }
    }
    return (int)size;
}

void iso__reader_clean(struct iso_fault *fault)
{
    size_t size = strlen(fault->text), tail = 0;
    for (size_t i = 0; i < size; i++) {
        const unsigned char c = (unsigned char)fault->text[i];
        const bool is_c1 = c == 0xc2 && (unsigned char)fault->text[i + 1] < 0xa0;
        if (c < 0x20 || c == 0x7f) {
            fault->text[i] = '?';
        } else if (is_c1 && i + 1 < size) {
            fault->text[i] = fault->text[i + 1] = '?';
        }
    }
    /* Only a line that fills its buffer was cut. */
    while (size + 1 == sizeof fault->text && tail < 3 && tail < size &&
           ((unsigned char)fault->text[size - 1 - tail] & 0xc0) == 0x80) {
        tail++;
    }
    if (size + 1 == sizeof fault->text && tail < size &&
        (unsigned char)fault->text[size - 1 - tail] >= 0xc0) {
        fault->text[size - 1 - tail] = '\0';
    }
}

int iso__reader_refuse(const struct iso__reader *reader, const char *format, ...)
{
    char flaw[sizeof reader->fault->text];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(flaw, sizeof flaw, format, arguments);
    va_end(arguments);
    if (!reader->words) {
        (void)iso_fault_set(reader->fault, -EINVAL, "policy: %s", flaw);
    } else if (reader->token) {
        (void)iso_fault_set(reader->fault, -EINVAL, "%s \"%s\": %s", reader->words, reader->token,
                            flaw);
    } else {
        (void)iso_fault_set(reader->fault, -EINVAL, "%s number %zu: %s", reader->words,
                            reader->number, flaw);
    }
    iso__reader_clean(reader->fault);
    return -EINVAL;
}

int iso__reader_no_memory(const struct iso__reader *reader)
{
    return iso_fault_set(reader->fault, -ENOMEM, "out of memory");
}

int iso__reader_members(const struct iso__reader *reader, const char *what, const json_t *value,
                        const char *const *members)
{
    if (!json_is_object(value)) {
        return iso__reader_refuse(reader, "%s is not an object", what);
    }
    const char *member;
    json_t *part;
    json_object_foreach((json_t *)value, member, part)
    {
        size_t i = 0;
        while (members[i] && strcmp(members[i], member) != 0) {
            i++;
        }
        if (!members[i]) {
            return iso__reader_refuse(reader, "%s has an unknown member \"%.*s\"", what,
                                      iso__quoted(member), member);
        }
    }
    return 0;
}

int iso__reader_text(const struct iso__reader *reader, const json_t *object, const char *member,
                     const char **out)
{
    const json_t *value = json_object_get(object, member);
    if (!value) {
        return 0;
    }
    if (!json_is_string(value)) {
        return iso__reader_refuse(reader, "\"%s\" is not a string", member);
    }
    *out = json_string_value(value);
    return 0;
}

int iso__reader_truth(const struct iso__reader *reader, const json_t *object, const char *member,
                      bool *out)
{
    const json_t *value = json_object_get(object, member);
    if (!value) {
        return 0;
    }
    if (!json_is_boolean(value)) {
        return iso__reader_refuse(reader, "\"%s\" is neither true nor false", member);
    }
    *out = json_is_true(value);
    return 0;
}

int iso__reader_number(const struct iso__reader *reader, const json_t *object, const char *member,
                       int32_t *out)
{
    const json_t *value = json_object_get(object, member);
    if (!value) {
        return 0;
    }
    const json_int_t number = json_integer_value(value);
    if (!json_is_integer(value) || number < INT32_MIN || number > INT32_MAX) {
        return iso__reader_refuse(reader, "\"%s\" is not a whole number of 32 bits", member);
    }
    *out = (int32_t)number;
    return 0;
}

int iso__reader_list(const struct iso__reader *reader, const json_t *object, const char *member,
                     size_t max, const json_t **out)
{
    const json_t *value = json_object_get(object, member);
    if (!value) {
        return 0;
    }
    if (!json_is_array(value)) {
        return iso__reader_refuse(reader, "\"%s\" is not an array", member);
    }
    if (json_array_size(value) > max) {
        return iso__reader_refuse(reader, "\"%s\" has %zu entries, at most %zu", member,
                                  json_array_size(value), max);
    }
    *out = value;
    return 0;
}

int iso__reader_reference(const struct iso__reader *reader, const json_t *object,
                          const char *member, enum iso__kind_id kind, bool required, uint16_t *out)
{
    const char *token = NULL;
    const int error = iso__reader_text(reader, object, member, &token);
    if (error != 0) {
        return error;
    }
    if (!token) {
        return required ? iso__reader_refuse(reader, "has no \"%s\"", member) : 0;
    }
    const json_t *index = json_object_get(reader->indices[kind], token);
    if (!index) {
        return iso__reader_refuse(reader, "there is no %s \"%.*s\"", iso__kinds[kind].words,
                                  iso__quoted(token), token);
    }
    *out = (uint16_t)json_integer_value(index);
    return 0;
}
