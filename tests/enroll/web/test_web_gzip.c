/* Long answers are compressed for clients that accept it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <zlib.h>

#include "enroll/web/http/gzip.h"

enum { SIZE = 100000 };

static void clients_that_accept_gzip_are_recognised(void **state)
{
    static const struct {
        const char *header;
        bool accepts;
    } headers[] = {
        {NULL, false},
        {"", false},
        {"gzip", true},
        {"GZIP", true},
        {"deflate, gzip;q=1.0, *;q=0.5", true},
        {"br,gzip", true},
        {"gzip;q=0", false},
        {"gzip; q=0.000", false},
        {"gzip;q=0.001", true},
        {"xgzip", false},
        {"gzipped", false},
        {"identity", false},
        {"gzip;", true},
        {", ,\t", false},
    };
    (void)state;
    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++) {
        if (web__accepts_gzip(headers[i].header) != headers[i].accepts) {
            fail_msg("Accept-Encoding: %s", headers[i].header);
        }
    }
}

static void a_text_comes_back_from_gzip(void **state)
{
    static char original[SIZE];
    static uint8_t back[SIZE + 1];
    char *text = malloc(SIZE);
    size_t size = SIZE;
    z_stream stream = {.next_out = back, .avail_out = sizeof back};
    (void)state;
    assert_non_null(text);
    for (int i = 0; i < SIZE; i++) {
        original[i] = (char)('a' + (i % 317 * i / 7 + i) % 23);
    }
    memcpy(text, original, SIZE);
    assert_true(web__gzip(&text, &size));
    assert_true(size < SIZE);
    stream.next_in = (Bytef *)text;
    stream.avail_in = (uInt)size;
    assert_int_equal(inflateInit2(&stream, 15 + 16), Z_OK); /* gzip alone */
    assert_int_equal(inflate(&stream, Z_FINISH), Z_STREAM_END);
    assert_int_equal(stream.total_out, SIZE);
    assert_memory_equal(back, original, SIZE);
    assert_int_equal(inflateEnd(&stream), Z_OK);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(clients_that_accept_gzip_are_recognised),
        cmocka_unit_test(a_text_comes_back_from_gzip),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
