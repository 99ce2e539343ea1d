/* The format TZif of RFC 8536: a header and data with times of 32 bits for old readers, then a
 * header and data with times of 64 bits, which is read here, then the rule between two newlines. */
#include <errno.h>
#include <string.h>

#include "core/base/fault.h"
#include "firmware/policy/zone.h"

enum {
    HEADER_SIZE = 44,
    COUNTS_AT = 20,
    TYPE_SIZE = 6,
};

/* The six counts of a header, in their order. */
struct counts {
    uint32_t ut, standard, leap, changes, types, letters;
};

static uint32_t big_u32(const uint8_t *p)
{
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

static int64_t big_i64(const uint8_t *p)
{
    return (int64_t)((uint64_t)big_u32(p) << 32 | big_u32(p + 4));
}

/* Reads the counts of the header at `at`, and the size of the data after it. A sum of six counts of
 * 32 bits, each times at most 12, fits into 64 bits. */
static bool read_header(const uint8_t *bytes, size_t size, size_t at, int time_size,
                        struct counts *counts, size_t *data_size)
{
    if (size < at || size - at < HEADER_SIZE || memcmp(bytes + at, "TZif", 4) != 0) {
        return false;
    }
    const uint8_t *p = bytes + at + COUNTS_AT;
    *counts = (struct counts){big_u32(p),      big_u32(p + 4),  big_u32(p + 8),
                              big_u32(p + 12), big_u32(p + 16), big_u32(p + 20)};
    const uint64_t data = (uint64_t)counts->changes * (uint64_t)(time_size + 1) +
                          (uint64_t)counts->types * TYPE_SIZE + counts->letters +
                          (uint64_t)counts->leap * (uint64_t)(time_size + 4) + counts->standard +
                          counts->ut;
    *data_size = (size_t)data;
    return data <= size - at - HEADER_SIZE;
}

/* Reads the changes of the table: times, then one byte for each that names its type. */
static bool read_changes(const uint8_t *data, const struct counts *counts, struct iso_zone *zone)
{
    const uint8_t *type_of = data + (size_t)8 * counts->changes;
    const uint8_t *types = type_of + counts->changes;
    zone->first_offset_s = (int32_t)big_u32(types);
    zone->n = (uint16_t)counts->changes;
    for (uint32_t i = 0; i < counts->changes; i++) {
        if (type_of[i] >= counts->types) {
            return false;
        }
        zone->at_s[i] = big_i64(data + (size_t)8 * i);
        zone->offset_s[i] = (int32_t)big_u32(types + (size_t)TYPE_SIZE * type_of[i]);
    }
    return true;
}

/* Reads the rule, which is all of the file after the data. */
static int read_rule(const uint8_t *footer, size_t size, const char *name,
                     struct iso_zone_rule *rule, struct iso_fault *fault)
{
    if (size < 2 || footer[0] != '\n' || footer[size - 1] != '\n') {
        return iso_fault_set(fault, -EBADMSG, "zone %s: the file is cut off before its rule", name);
    }
    if (size == 2) {
        return iso_fault_set(fault, -EOPNOTSUPP, "zone %s: the file has no rule for later years",
                             name);
    }
    if (iso_zone_rule_read((const char *)footer + 1, size - 2, rule) != 0) {
        return iso_fault_set(fault, -EBADMSG, "zone %s: the rule for later years is wrong", name);
    }
    return 0;
}

/* Reads what follows the data of version 1: `at` is the header of the data that count. */
static int read_second(const char *name, const uint8_t *bytes, size_t size, size_t at,
                       struct iso_zone *zone, struct iso_fault *fault)
{
    struct counts counts;
    size_t data_size;
    if (!read_header(bytes, size, at, 8, &counts, &data_size) || counts.types == 0) {
        return iso_fault_set(fault, -EBADMSG, "zone %s: the file is cut off", name);
    }
    if (counts.leap != 0) {
        return iso_fault_set(fault, -EOPNOTSUPP, "zone %s: it counts leap seconds", name);
    }
    if (counts.changes > ISO_ZONE_CHANGES_MAX) {
        return iso_fault_set(fault, -E2BIG, "zone %s: %lu changes of its clock, at most %d", name,
                             (unsigned long)counts.changes, ISO_ZONE_CHANGES_MAX);
    }
    if (!read_changes(bytes + at + HEADER_SIZE, &counts, zone)) {
        return iso_fault_set(fault, -EBADMSG, "zone %s: its table contradicts itself", name);
    }
    const size_t footer = at + HEADER_SIZE + data_size;
    const int error = read_rule(bytes + footer, size - footer, name, &zone->rule, fault);
    if (error == 0 && !iso_zone_is_sound(zone)) {
        return iso_fault_set(fault, -EBADMSG, "zone %s: its table contradicts itself", name);
    }
    return error;
}

int iso_zone_read(const char *name, const uint8_t *bytes, size_t size, struct iso_zone *zone,
                  struct iso_fault *fault)
{
    const size_t length = strlen(name);
    if (length == 0 || length >= ISO_ZONE_NAME_SIZE) {
        return iso_fault_set(fault, -EINVAL,
                             "zone \"%.60s\": the name has %zu letters, not 1 to %d", name, length,
                             ISO_ZONE_NAME_SIZE - 1);
    }
    struct counts counts;
    size_t data_size;
    if (!read_header(bytes, size, 0, 4, &counts, &data_size)) {
        return iso_fault_set(fault, -EBADMSG, "zone %s: the file is not a time zone", name);
    }
    if (bytes[4] < '2' || bytes[4] > '4') {
        return iso_fault_set(fault, -EOPNOTSUPP, "zone %s: the file is not of version 2 to 4",
                             name);
    }
    struct iso_zone read = {0};
    memcpy(read.name, name, length + 1);
    const int error = read_second(name, bytes, size, HEADER_SIZE + data_size, &read, fault);
    if (error == 0) {
        *zone = read;
    }
    return error;
}
