/* The sockets of those who watch: a slow client loses records and nothing waits for it. */
#include <errno.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "core/base/bytes.h"
#include "firmware/stream/stream_list.h"

static uint8_t record[ISO_OUTLINE_BYTES];

static int add(struct iso_stream_list *list, enum iso_stream_kind kind, uid_t user)
{
    return iso_stream_list_add(list, kind, user, NULL);
}

static void send_number(struct iso_stream_list *list, uint32_t number)
{
    (void)iso_put_u32(record + 4, number);
    iso_stream_list_send(list, ISO_STREAM_OUTLINE, record, sizeof record);
}

/* Reads a record. Returns its number, or a negative errno; `missed` receives its count. */
static int64_t receive(int fd, int *missed)
{
    uint8_t bytes[ISO_STREAM_BYTES_MAX];
    const ssize_t n = recv(fd, bytes, sizeof bytes, 0);
    if (n <= 0) {
        return n < 0 ? -errno : -EPIPE;
    }
    assert_int_equal(n, ISO_OUTLINE_BYTES);
    *missed = iso_get_u16(bytes + 2);
    return iso_get_u32(bytes + 4);
}

static void every_record_arrives_whole(void **state)
{
    struct iso_stream_list list = {.n = 0};
    int missed = 0;
    (void)state;
    const int one = add(&list, ISO_STREAM_OUTLINE, 1);
    const int other = add(&list, ISO_STREAM_OUTLINE, 2);
    const int relief = add(&list, ISO_STREAM_RELIEF, 1);
    assert_true(one >= 0 && other >= 0 && relief >= 0);
    assert_true(iso_stream_list_has(&list, ISO_STREAM_RELIEF));
    assert_int_equal(receive(one, &missed), -EAGAIN); /* it does not wait */
    for (uint32_t i = 1; i <= 3; i++) {
        send_number(&list, i);
        assert_int_equal(receive(one, &missed), i);
        assert_int_equal(receive(other, &missed), i);
        assert_int_equal(missed, 0);
    }
    assert_int_equal(receive(relief, &missed), -EAGAIN);
    iso_stream_list_end(&list, ISO_STREAM_RELIEF);
    assert_int_equal(receive(relief, &missed), -EPIPE);
    iso_stream_list_end(&list, ISO_STREAM_OUTLINE);
    assert_int_equal(list.n, 0);
    (void)close(one);
    (void)close(other);
    (void)close(relief);
}

static void a_slow_client_loses_records_and_learns_how_many(void **state)
{
    struct iso_stream_list list = {.n = 0};
    int missed = 0;
    uint32_t kept = 0;
    (void)state;
    const int slow = add(&list, ISO_STREAM_OUTLINE, 1);
    const int quick = add(&list, ISO_STREAM_OUTLINE, 2);
    for (uint32_t i = 1; i <= 100; i++) {
        send_number(&list, i);
        assert_int_equal(receive(quick, &missed), i);
    }
    for (int64_t i = receive(slow, &missed); i >= 0; i = receive(slow, &missed)) {
        assert_int_equal(i, ++kept); /* the oldest ones are kept, and there are few */
        assert_int_equal(missed, 0);
    }
    assert_in_range(kept, 1, 20);
    send_number(&list, 101);
    assert_int_equal(receive(slow, &missed), 101);
    assert_int_equal(missed, 100 - kept);
    send_number(&list, 102);
    assert_int_equal(receive(slow, &missed), 102);
    assert_int_equal(missed, 0);
    iso_stream_list_end(&list, ISO_STREAM_OUTLINE);
    (void)close(slow);
    (void)close(quick);
}

static void the_count_of_missed_records_does_not_wrap(void **state)
{
    struct iso_stream_list list = {.n = 0};
    int missed = 0;
    (void)state;
    const int slow = add(&list, ISO_STREAM_OUTLINE, 1);
    for (uint32_t i = 0; i < 70000; i++) {
        send_number(&list, i);
    }
    while (receive(slow, &missed) >= 0) {
    }
    send_number(&list, 70000);
    assert_int_equal(receive(slow, &missed), 70000);
    assert_int_equal(missed, UINT16_MAX);
    iso_stream_list_end(&list, ISO_STREAM_OUTLINE);
    (void)close(slow);
}

static void a_closed_stream_is_removed(void **state)
{
    struct iso_stream_list list = {.n = 0};
    int missed = 0;
    (void)state;
    const int first = add(&list, ISO_STREAM_OUTLINE, 1);
    const int second = add(&list, ISO_STREAM_OUTLINE, 1);
    (void)close(first);
    send_number(&list, 1);
    assert_int_equal(list.n, 1);
    assert_int_equal(receive(second, &missed), 1);
    (void)close(second);
    const int third = add(&list, ISO_STREAM_OUTLINE, 1); /* without a record in between */
    assert_int_equal(list.n, 1);
    iso_stream_list_end(&list, ISO_STREAM_OUTLINE);
    (void)close(third);
}

static void a_client_cannot_send(void **state)
{
    struct iso_stream_list list = {.n = 0};
    (void)state;
    const int fd = add(&list, ISO_STREAM_OUTLINE, 1);
    assert_int_equal(send(fd, "x", 1, MSG_NOSIGNAL), -1);
    assert_int_equal(errno, EPIPE);
    iso_stream_list_end(&list, ISO_STREAM_OUTLINE);
    (void)close(fd);
}

static void no_user_takes_all_streams(void **state)
{
    struct iso_stream_list list = {.n = 0};
    struct iso_fault fault = {.text = ""};
    int fds[ISO_STREAMS_MAX];
    int n = 0;
    (void)state;
    for (uid_t user = 1; user <= 4; user++) {
        for (int i = 0; i < ISO_STREAMS_PER_USER; i++) {
            fds[n] = add(&list, ISO_STREAM_OUTLINE, user);
            assert_true(fds[n++] >= 0);
        }
        if (user == 1) {
            assert_int_equal(iso_stream_list_add(&list, ISO_STREAM_RELIEF, 1, &fault), -EBUSY);
            assert_string_equal(fault.text, "user 1 has 4 streams already");
        }
    }
    assert_int_equal(iso_stream_list_add(&list, ISO_STREAM_OUTLINE, 9, &fault), -EBUSY);
    assert_string_equal(fault.text, "16 streams are open already");
    (void)close(fds[--n]);
    fds[n] = add(&list, ISO_STREAM_OUTLINE, 9);
    assert_true(fds[n++] >= 0);
    iso_stream_list_end(&list, ISO_STREAM_OUTLINE);
    while (n > 0) {
        (void)close(fds[--n]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_record_arrives_whole),
        cmocka_unit_test(a_slow_client_loses_records_and_learns_how_many),
        cmocka_unit_test(the_count_of_missed_records_does_not_wrap),
        cmocka_unit_test(a_closed_stream_is_removed),
        cmocka_unit_test(a_client_cannot_send),
        cmocka_unit_test(no_user_takes_all_streams),
    };
    record[0] = ISO_STREAM_VERSION;
    record[1] = ISO_STREAM_OUTLINE;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
