/* The file with the key of a card reader: what it may contain, and who may have access to it. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/daemon/reader_key.h"
#include "tests/support/scratch.h"

static const char *path;
static uint8_t key[ISO_OSDP_KEY_BYTES];
static struct iso_fault fault;

static int read_text(const char *directory, const char *text, mode_t mode)
{
    path = scratch_path(directory, "reader.key");
    scratch_write_text(path, text);
    assert_int_equal(chmod(path, mode), 0);
    memset(key, 0x5A, sizeof key);
    fault = (struct iso_fault){.text = ""};
    const int error = iso_reader_key_read(path, geteuid(), key, &fault);
    for (size_t i = 0; error && i < sizeof key; i++) {
        assert_int_equal(key[i], 0x5A);
    }
    assert_int_equal(error == 0, fault.text[0] == '\0');
    return error;
}

static void reads_one_line_of_digits(void **state)
{
    static const uint8_t expected[ISO_OSDP_KEY_BYTES] = {0x00, 0x11, 0x22, 0x33, 0x44, 0x55,
                                                         0x66, 0x77, 0x88, 0x99, 0xAA, 0xBB,
                                                         0xCC, 0xDD, 0xEE, 0xFF};
    static const char *const texts[] = {"00112233445566778899aabbccddeeff",
                                        "00112233445566778899AABBCCDDEEFF\n",
                                        "00112233445566778899aAbBcCdDeEfF\r\n"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        assert_int_equal(read_text(*state, texts[i], 0640), 0);
        assert_memory_equal(key, expected, sizeof key);
    }
}

static void refuses_other_contents(void **state)
{
    static const char *const wrong[] = {"",
                                        "\n",
                                        "00112233445566778899aabbccddeef",
                                        "00112233445566778899aabbccddeefg",
                                        "00112233445566778899aabbccddee f",
                                        "00112233445566778899aabbccddeef\n\n",
                                        " 0112233445566778899aabbccddeeff"};
    char text[256];
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_int_equal(read_text(*state, wrong[i], 0600), -EBADMSG);
        (void)snprintf(text, sizeof text, "%s: is not one line of 32 hexadecimal digits", path);
        assert_string_equal(fault.text, text);
    }
    assert_int_equal(read_text(*state, "00112233445566778899aabbccddeeff00", 0600), -EBADMSG);
    assert_int_equal(read_text(*state, "00112233445566778899aabbccddeeff000", 0600), -EFBIG);
}

static void refuses_keys_that_everyone_knows(void **state)
{
    assert_int_equal(read_text(*state, "303132333435363738393a3b3c3d3e3f\n", 0600), -EBADMSG);
    assert_int_equal(read_text(*state, "00000000000000000000000000000000\n", 0600), -EBADMSG);
    assert_int_equal(read_text(*state, "ffffffffffffffffffffffffffffffff\n", 0600), -EBADMSG);
    assert_int_equal(read_text(*state, "fffffffffffffffffffffffffffffffe\n", 0600), 0);
}

static void refuses_a_file_that_others_can_read_or_change(void **state)
{
    static const mode_t wrong[] = {0644, 0604, 0602, 0660, 0641};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_int_equal(read_text(*state, "00112233445566778899aabbccddeeff\n", wrong[i]), -EPERM);
    }
    assert_int_equal(read_text(*state, "00112233445566778899aabbccddeeff\n", 0600), 0);
    assert_int_equal(iso_reader_key_read(path, geteuid() + 1, key, &fault), -EPERM);
    assert_int_equal(iso_reader_key_read(scratch_path(*state, "none"), 0, key, &fault), -ENOENT);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, scratch_setup, scratch_teardown)
    const struct CMUnitTest tests[] = {
        TEST(reads_one_line_of_digits),
        TEST(refuses_other_contents),
        TEST(refuses_keys_that_everyone_knows),
        TEST(refuses_a_file_that_others_can_read_or_change),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
