/* Values of statements and fields of results, in PostgreSQL's binary form. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/store/hub_db.h"

/* The types' numbers in pg_type, which are the same in every PostgreSQL. */
enum { OID_SWITCH = 16, OID_BYTES = 17, OID_INTEGER = 20, OID_TEXT = 25, OID_ID = 2950 };

static void add(struct hub_values *values, Oid type, const void *bytes, size_t size)
{
    if (values->n == HUB_DB_VALUES_MAX) {
        abort(); /* a fault of the program: the statement has more values than there is room */
    }
    values->types[values->n] = type;
    values->values[values->n] = bytes;
    values->lengths[values->n] = (int)size;
    values->n++;
}

void hub_value_integer(struct hub_values *values, int64_t value)
{
    uint8_t *number = values->numbers[values->n];
    for (int i = 0; i < 8; i++) {
        number[i] = (uint8_t)((uint64_t)value >> (8 * (7 - i)));
    }
    add(values, OID_INTEGER, number, 8);
}

void hub_value_switch(struct hub_values *values, bool value)
{
    values->numbers[values->n][0] = value;
    add(values, OID_SWITCH, values->numbers[values->n], 1);
}

void hub_value_text(struct hub_values *values, const char *text)
{
    add(values, OID_TEXT, text, text ? strlen(text) : 0);
}

void hub_value_bytes(struct hub_values *values, const void *bytes, size_t size)
{
    add(values, OID_BYTES, bytes, size);
}

void hub_value_id(struct hub_values *values, const struct iso_fleet_id *id)
{
    add(values, OID_ID, id ? id->bytes : NULL, sizeof id->bytes);
}

int64_t hub_db_changed(const PGresult *result)
{
    /* libpq does not change the result, but its prototype is older than const. */
    const char *text = PQcmdTuples((PGresult *)(uintptr_t)result);
    int64_t n = 0;
    for (; *text; text++) {
        n = 10 * n + (*text - '0');
    }
    return n;
}

/* The bytes of a field that has to have a size. A field of another type is a fault of the program:
 * the statement has to deliver what is read. */
static const uint8_t *field(const PGresult *result, int row, int column, size_t size)
{
    if (PQgetisnull(result, row, column)) {
        return NULL;
    }
    if ((size_t)PQgetlength(result, row, column) != size) {
        abort();
    }
    return (const uint8_t *)PQgetvalue(result, row, column);
}

int64_t hub_row_integer(const PGresult *result, int row, int column)
{
    const uint8_t *bytes = field(result, row, column, 8);
    uint64_t value = 0;
    for (int i = 0; bytes && i < 8; i++) {
        value = value << 8 | bytes[i];
    }
    return (int64_t)value;
}

bool hub_row_switch(const PGresult *result, int row, int column)
{
    const uint8_t *bytes = field(result, row, column, 1);
    return bytes && bytes[0];
}

const char *hub_row_text(const PGresult *result, int row, int column)
{
    return PQgetisnull(result, row, column) ? "" : PQgetvalue(result, row, column);
}

const uint8_t *hub_row_bytes(const PGresult *result, int row, int column, size_t *size)
{
    *size = (size_t)PQgetlength(result, row, column);
    return PQgetisnull(result, row, column) ? NULL
                                            : (const uint8_t *)PQgetvalue(result, row, column);
}

struct iso_fleet_id hub_row_id(const PGresult *result, int row, int column)
{
    struct iso_fleet_id id = {.bytes = {0}};
    const uint8_t *bytes = field(result, row, column, sizeof id.bytes);
    if (bytes) {
        memcpy(id.bytes, bytes, sizeof id.bytes);
    }
    return id;
}

int hub_row_copy(const PGresult *result, int row, int column, void *out, size_t size)
{
    size_t found = 0;
    const uint8_t *bytes = hub_row_bytes(result, row, column, &found);
    if (!bytes || found != size) {
        return -EBADMSG;
    }
    memcpy(out, bytes, size);
    return 0;
}
