/* The turns of requests that check or make a password. */
#include <sys/epoll.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/web/login/turns.h"
#include "tests/enroll/web/rigs/exchange_rig.h"

static void answer_in_turn(struct web_login *login, struct web_exchange *exchange)
{
    (void)login;
    web_exchange_done(exchange);
}

static int on_other(sd_event_source *source, int fd, uint32_t events, void *context)
{
    (void)fd;
    (void)events;
    *(bool *)context = true;
    return sd_event_source_set_enabled(source, SD_EVENT_OFF);
}

static void between_two_turns_the_loop_goes_on(void **state)
{
    struct web_exchange exchanges[3];
    struct web_turns *turns;
    sd_event *event;
    bool other = false;
    int ends[2];
    (void)state;
    assert_int_equal(pipe(ends), 0);
    assert_true(sd_event_new(&event) >= 0);
    assert_int_equal(web_turns_new(event, NULL, &turns), 0);
    for (int i = 0; i < 3; i++) {
        exchanges[i] = rig_exchange(WEB_ROLE_NONE, 0, NULL);
        web_turns_wait(turns, &exchanges[i], answer_in_turn);
        assert_false(exchanges[i].answered);
    }
    assert_true(sd_event_add_io(event, NULL, ends[1], EPOLLOUT, on_other, &other) >= 0);
    while (!other || !exchanges[0].answered) {
        assert_true(sd_event_run(event, UINT64_MAX) > 0);
    }
    assert_false(exchanges[2].answered);
    web_turns_free(turns); /* those that still wait are answered */
    rig_expect(event, &exchanges[0], 204, NULL);
    rig_expect(event, &exchanges[2], 503, "busy");
    for (int i = 0; i < 3; i++) {
        assert_true(exchanges[i].answered);
        rig_exchange_done(&exchanges[i]);
    }
    sd_event_unref(event);
    (void)close(ends[0]);
    (void)close(ends[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(between_two_turns_the_loop_goes_on)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
