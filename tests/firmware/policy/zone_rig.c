#include "tests/firmware/policy/zone_rig.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

uint8_t *zone_rig_bytes(const char *name, size_t *size)
{
    char path[512];
    (void)snprintf(path, sizeof path, ZONE_RIG_FOLDER "/%s", name);
    FILE *file = fopen(path, "rb");
    if (!file) {
        return NULL;
    }
    enum { SIZE_MAX_BYTES = 1 << 16 };
    uint8_t *bytes = malloc(SIZE_MAX_BYTES);
    assert_non_null(bytes);
    *size = fread(bytes, 1, SIZE_MAX_BYTES, file);
    (void)fclose(file);
    return bytes;
}

void zone_rig_read(const char *name, struct iso_zone *zone)
{
    size_t size = 0;
    uint8_t *bytes = zone_rig_bytes(name, &size);
    struct iso_fault fault = {.text = "no such file"};
    const int error = bytes ? iso_zone_read(name, bytes, size, zone, &fault) : -1;
    free(bytes);
    if (error != 0) {
        fail_msg("%s: %s", name, fault.text);
    }
}

void zone_rig_fixed(int32_t offset_s, struct iso_zone *zone)
{
    memset(zone, 0, sizeof *zone);
    (void)strcpy(zone->name, "fixed");
    zone->rule.standard_s = offset_s;
}

static uint8_t *put(uint8_t *p, uint64_t number, int n_bytes)
{
    for (int i = n_bytes - 1; i >= 0; i--) {
        *p++ = (uint8_t)(number >> (8 * i));
    }
    return p;
}

static uint8_t *put_header(uint8_t *p, char version, uint32_t leap, uint32_t n, uint32_t types,
                           uint32_t letters)
{
    memcpy(p, "TZif", 4);
    memset(p + 4, 0, 16);
    p[4] = (uint8_t)version;
    p = put(p + 20, 0, 4);
    p = put(p, 0, 4);
    p = put(p, leap, 4);
    p = put(p, n, 4);
    p = put(p, types, 4);
    return put(p, letters, 4);
}

size_t zone_file_write(const struct zone_file *file, uint8_t bytes[ZONE_FILE_SIZE])
{
    uint8_t *p = put_header(bytes, file->version, 0, 0, 1, 1);
    memset(p, 0, 7); /* one type and one letter */
    p = put_header(p + 7, file->version, file->n_leap, file->n, file->n_types, 4);
    for (uint32_t i = 0; i < file->n; i++) {
        p = put(p, (uint64_t)file->at_s[i], 8);
    }
    for (uint32_t i = 0; i < file->n; i++) {
        *p++ = file->type_of[i];
    }
    for (uint32_t i = 0; i < file->n_types; i++) {
        p = put(put(p, (uint32_t)file->offset_s[i], 4), 0, 2);
    }
    memset(p, 0, 4); /* no letters; read as an offset they would be a right one */
    p += 4;
    for (uint32_t i = 0; i < file->n_leap; i++) {
        p = put(put(p, 78796800, 8), i + 1, 4);
    }
    memcpy(p, file->footer, strlen(file->footer));
    return (size_t)(p - bytes) + strlen(file->footer);
}
