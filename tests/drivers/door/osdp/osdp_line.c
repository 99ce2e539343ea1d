#include "tests/drivers/door/osdp/osdp_line.h"

#include <fcntl.h>
#include <poll.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

void osdp_line_open(struct osdp_line *line, uint32_t baud)
{
    memset(line, 0, sizeof *line);
    line->master = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    assert_true(line->master >= 0);
    assert_int_equal(grantpt(line->master), 0);
    assert_int_equal(unlockpt(line->master), 0);
    assert_int_equal(ptsname_r(line->master, line->path, sizeof line->path), 0);
    line->baud = baud;
    line->panel.address = 5;
    line->panel.sequence = -1;
}

void osdp_line_close(struct osdp_line *line)
{
    (void)close(line->master);
}

/* Ten bits a byte, four bytes at a time. */
void osdp_line_write(const struct osdp_line *line, const uint8_t *bytes, size_t n)
{
    for (size_t at = 0; at < n;) {
        const size_t piece = line->baud && n - at > 4 ? 4 : n - at;
        assert_int_equal(write(line->master, bytes + at, piece), piece);
        at += piece;
        if (line->baud) {
            const struct timespec time = {0,
                                          (long)(piece * 10 * UINT64_C(1000000000) / line->baud)};
            (void)nanosleep(&time, NULL);
        }
    }
}

void osdp_line_read(struct osdp_line *line, struct panel_reply *reply)
{
    uint8_t bytes[PANEL_FRAME_BYTES];
    size_t n = 0;
    reply->code = -1;
    for (;;) {
        struct pollfd wait = {.fd = line->master, .events = POLLIN};
        if (poll(&wait, 1, 200) <= 0) {
            return;
        }
        const ssize_t more = read(line->master, bytes + n, sizeof bytes - n);
        assert_true(more > 0);
        n += (size_t)more;
        const uint8_t *som = memchr(bytes, 0x53, n);
        const size_t rest = som ? n - (size_t)(som - bytes) : 0;
        if (rest >= 5 && rest >= (som[2] | (size_t)som[3] << 8)) {
            panel_read(&line->panel, som, rest, reply);
            return;
        }
    }
}

void osdp_line_insist(struct osdp_line *line, struct panel_reply *reply)
{
    do {
        osdp_line_write(line, line->panel.frame, line->panel.n_frame);
        osdp_line_read(line, reply);
    } while (reply->code < 0);
}

int osdp_line_ask(struct osdp_line *line, uint8_t command, const void *data, size_t n,
                  struct panel_reply *reply)
{
    panel_make(&line->panel, command, data, n);
    osdp_line_insist(line, reply);
    return reply->code;
}

bool osdp_line_secure(struct osdp_line *line, const uint8_t key[16])
{
    static uint8_t rnd_a[8] = {9, 8, 7, 6, 5, 4, 3, 2};
    struct panel *panel = &line->panel;
    struct panel_reply reply;
    uint8_t proof[16];
    const int which = memcmp(key, "0123456789:;<=>?", 16) != 0;
    rnd_a[0]++; /* each handshake has numbers of its own */
    panel->sequence = -1;
    panel_challenge(panel, key, rnd_a);
    panel_make_plain(panel, 0x76, 0x11, which, rnd_a, 8);
    osdp_line_insist(line, &reply);
    if (!panel_answer(panel, &reply, proof)) {
        return false;
    }
    panel_make_plain(panel, 0x77, 0x13, which, proof, 16);
    osdp_line_insist(line, &reply);
    return panel_begin(panel, &reply);
}
