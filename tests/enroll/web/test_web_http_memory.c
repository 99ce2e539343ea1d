/* The memory of the web server with many streams. */
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/enroll/web/rigs/stream_rig.h"

enum { RESIDENT_MOST_KB = 12 << 10 };

/* Sanitizers and valgrind need memory of their own. */
extern void __asan_init(void) __attribute__((weak));
extern void __tsan_init(void) __attribute__((weak));

static bool is_under_valgrind(void)
{
    const char *preloaded = getenv("LD_PRELOAD");

    return preloaded && strstr(preloaded, "vgpreload");
}

/* Reads 16 streams until it is killed. */
static void read_streams(const char *headers)
{
    static struct https clients[STREAM_RIG_MOST];

    (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
    stream_rig.event = NULL;
    for (int i = 0; i < STREAM_RIG_MOST; i++) {
        stream_rig_begin(&clients[i], "/frames", headers, false);
    }
    for (;;) {
        for (int i = 0; i < STREAM_RIG_MOST; i++) {
            https_receive(&clients[i]);
            clients[i].n = 0;
        }
        https_pump(NULL, clients[0].fd);
    }
}

static void sixteen_streams_need_little_memory(void **state)
{
    const char *headers = web_rig_login(&stream_rig, "eve", WEB_ROLE_OBSERVER, NULL);
    uint8_t value = 0;
    long kb;
    (void)state;

    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        read_streams(headers);
    }
    for (const time_t end = time(NULL) + 10; stream_rig_opened < STREAM_RIG_MOST;) {
        assert_true(time(NULL) < end);
        https_pump(stream_rig.event, -1);
    }
    for (int frame = 0; frame < 100; frame++, value++) {
        for (int i = 0; i < STREAM_RIG_MOST; i++) {
            stream_rig_send(stream_rig_streams[i], value, 4000);
        }
        https_pump(stream_rig.event, -1);
    }
    kb = web_rig_resident_kb();
    assert_int_equal(stream_rig_closed, 0);
    assert_int_equal(kill(child, SIGKILL), 0);
    assert_int_equal(waitpid(child, NULL, 0), child);
    stream_rig_wait_until_closed(STREAM_RIG_MOST);
    print_message("resident with %d streams: %ld kB\n", STREAM_RIG_MOST, kb);
    if (!__asan_init && !__tsan_init && !is_under_valgrind()) {
        assert_true(kb < RESIDENT_MOST_KB);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(sixteen_streams_need_little_memory, stream_rig_setup,
                                        stream_rig_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
