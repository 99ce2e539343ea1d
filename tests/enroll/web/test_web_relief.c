/* The relief of an enrolment: who sees it, and its bytes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <sys/socket.h>
#include <zlib.h>

#include "firmware/contract/stream_record.h"
#include "tests/enroll/web/rigs/story_rig.h"

enum { COLUMNS = 5, ROWS = 3, DATA_AT = 4 + 20 };

static size_t write_relief(uint8_t *bytes)
{
    static struct iso_relief_record record;
    record = (struct iso_relief_record){
        .head = {.sequence = 9, .t_ns = 77}, .columns = COLUMNS, .rows = ROWS};
    for (int i = 0; i < COLUMNS * ROWS; i++) {
        record.depth_mm[i] = (uint16_t)(i % 4 == 3 ? 0 : 600 + 31 * i);
    }
    return iso_relief_record_write(&record, bytes);
}

/* Undoes what openapi.json describes, and compares with the record. */
static void expect_relief(const struct web_chunk *chunk, const uint8_t *record, size_t size)
{
    uint8_t deltas[2 * COLUMNS * ROWS + 8];
    uLongf n = sizeof deltas;
    const size_t length = chunk->bytes[0] | (size_t)chunk->bytes[1] << 8;
    assert_int_equal(length + 4, chunk->size);
    assert_memory_equal(chunk->bytes + 4, record, 20);
    assert_int_equal(uncompress(deltas, &n, chunk->bytes + DATA_AT, chunk->size - DATA_AT), Z_OK);
    assert_int_equal(n, size - 20);
    for (size_t i = 0; i < n / 2; i++) {
        const unsigned left = i % COLUMNS ? (unsigned)(record[18 + 2 * i] | record[19 + 2 * i] << 8)
                                          : 0;
        const unsigned depth = left + (unsigned)(deltas[2 * i] | deltas[2 * i + 1] << 8);
        assert_int_equal(depth & 0xffff, record[20 + 2 * i] | record[20 + 2 * i + 1] << 8);
    }
}

static bool has_received(void *context)
{
    return ((const struct web_stream *)context)->n_received > 0;
}

static void the_relief_is_for_the_session_that_began_it(void **state)
{
    static uint8_t bytes[ISO_STREAM_BYTES_MAX];
    const size_t size = write_relief(bytes);
    struct rig *rig = *state;
    struct rig_story story;
    if (!rig) {
        skip();
    }
    struct web_exchange early = rig_exchange(WEB_ROLE_ENROLLER, 1, NULL);
    web_api_get_relief(&rig->api, &early);
    rig_expect(rig->event, &early, 409, "no-enrolment");
    rig_exchange_done(&early);
    rig_story_begin(&story, rig);
    struct web_exchange own = rig_exchange(WEB_ROLE_ENROLLER, story.session, NULL);
    struct web_exchange other = rig_exchange(WEB_ROLE_ADMINISTRATOR, story.session + 1, NULL);
    web_api_get_relief(&rig->api, &own);
    web_api_get_relief(&rig->api, &other);
    rig_expect(rig->event, &other, 409, "no-enrolment");
    rig_exchange_done(&other);
    assert_int_equal(send(rig->service.relief_fd, bytes, size - 1, 0), size - 1); /* damaged */
    assert_int_equal(send(rig->service.relief_fd, bytes, size, 0), size);
    rig_wait(rig->event, has_received, own.stream, "a relief");
    assert_int_equal(own.stream->n_received, 1);
    expect_relief(own.stream->last, bytes, size);

    rig_send_status(rig, "enroll-completed", true, 12, 0.9, "");
    json_decref(rig_story_end(&story, "completed"));
    assert_true(own.stream->ended); /* it ends with the enrolment */
    rig_close(&own);
    rig_exchange_done(&own);
}

/* A stream that ends late sees nothing of the next person. */
static void a_relief_of_before_sees_nothing_of_the_next_person(void **state)
{
    static uint8_t bytes[ISO_STREAM_BYTES_MAX];
    const size_t size = write_relief(bytes);
    struct rig *rig = *state;
    struct rig_story story;
    if (!rig) {
        skip();
    }
    rig_story_begin(&story, rig);
    struct web_exchange before = rig_exchange(WEB_ROLE_ENROLLER, story.session, NULL);
    web_api_get_relief(&rig->api, &before);
    rig_expect(rig->event, &before, 200, NULL);
    rig_send_status(rig, "enroll-completed", true, 12, 0.9, "");
    json_decref(rig_story_end(&story, "completed"));
    before.stream->ended = false; /* as if the server had not noticed yet */
    rig->service.trace[0] = '\0';
    rig_story_begin(&story, rig);
    struct web_exchange own = rig_exchange(WEB_ROLE_ENROLLER, story.session, NULL);
    web_api_get_relief(&rig->api, &own);
    assert_int_equal(send(rig->service.relief_fd, bytes, size, 0), size);
    rig_wait(rig->event, has_received, own.stream, "a relief");
    assert_int_equal(before.stream->n_received, 0);
    rig_close(&before);
    rig_close(&own);
    rig_exchange_done(&before);
    rig_exchange_done(&own);
    rig_close(&story.events);
    rig_exchange_done(&story.events);
}

#define RIG_TEST(name) cmocka_unit_test_setup_teardown(name, rig_setup, rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        RIG_TEST(the_relief_is_for_the_session_that_began_it),
        RIG_TEST(a_relief_of_before_sees_nothing_of_the_next_person),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
