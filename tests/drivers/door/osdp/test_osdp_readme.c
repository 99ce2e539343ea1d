/* The conversation in drivers/door/osdp/README.md is what a device really replies. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/door/osdp/osdp_peripheral.h"

static int make_random(void *context, void *bytes, size_t n)
{
    (void)context;
    memset(bytes, 0, n);
    return 0;
}

static int store(void *context, const struct iso_osdp_saved *saved)
{
    (void)context;
    (void)saved;
    return 0;
}

/* Reads "`53 05 ...`" at the next backquote of a row. Returns what follows it, or NULL. */
static const char *read_bytes(const char *at, uint8_t *bytes, size_t *n)
{
    at = strchr(at, '`');
    if (!at) {
        return NULL;
    }
    *n = 0;
    for (at++; *at != '`'; at += *at == ' ') {
        char *end;
        assert_true(*n < 64);
        bytes[(*n)++] = (uint8_t)strtoul(at, &end, 16);
        assert_int_equal(end - at, 2);
        at = end;
    }
    return at + 1;
}

static void check_row(struct iso_osdp_peripheral *device, const char *row)
{
    static const uint8_t card[] = {0x88, 0x89, 0x33, 0xC0}; /* 17 4711 in 26 bits */
    uint8_t command[64], expected[64], reply[ISO_OSDP_FRAME_BYTES];
    size_t n_command, n_expected;
    const char *at = read_bytes(row, command, &n_command);
    assert_non_null(at);
    assert_non_null(read_bytes(at, expected, &n_expected));
    if (strstr(row, "RAW: the card")) {
        assert_int_equal(iso_osdp_peripheral_card(device, card, 26), 0);
    }
    print_message("%.40s\n", row);
    assert_int_equal(iso_osdp_peripheral_receive(device, command, n_command, 1000, reply),
                     n_expected);
    assert_memory_equal(reply, expected, n_expected);
    (void)iso_osdp_peripheral_sent(device);
}

static void test_conversation(void **state)
{
    (void)state;
    char row[1024];
    int rows = 0;
    struct iso_osdp_peripheral *device;
    const struct iso_osdp_setup setup = {
        .saved = {.address = 5, .baud = 9600},
        .plain = true,
        .model = 1,
        .version = 1,
        .serial = 0x12345678,
        .firmware = {0, 1, 0},
        .inputs = 1,
        .random = make_random,
        .store = store,
    };
    assert_int_equal(iso_osdp_peripheral_new(&setup, &device), 0);
    FILE *file = fopen(ISOTHERM_SOURCE_DIR "/drivers/door/osdp/README.md", "r");
    assert_non_null(file);
    while (fgets(row, sizeof row, file)) {
        if (row[0] == '|' && strstr(row, "| `53 ")) {
            check_row(device, row);
            rows++;
        }
    }
    assert_int_equal(fclose(file), 0);
    assert_int_equal(rows, 15);
    iso_osdp_peripheral_free(device);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_conversation)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
