#include "tests/drivers/door/osdp/osdp_bench.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

const uint8_t bench_key[16] = {0x0b, 0x1c, 0x2d, 0x3e, 0x4f, 0x50, 0x61, 0x72,
                               0x83, 0x94, 0xa5, 0xb6, 0xc7, 0xd8, 0xe9, 0xfa};
const uint8_t bench_default_key[16] = "0123456789:;<=>?";

static int make_random(void *context, void *bytes, size_t n)
{
    struct bench *bench = context;
    for (size_t i = 0; i < n; i++) {
        ((uint8_t *)bytes)[i] = bench->random++;
    }
    return bench->random_error;
}

static int store(void *context, const struct iso_osdp_saved *saved)
{
    struct bench *bench = context;
    if (!bench->store_error) {
        bench->saved = *saved;
        bench->stores++;
    }
    return bench->store_error;
}

struct iso_osdp_setup bench_setup(struct bench *bench, bool has_key, bool plain)
{
    struct iso_osdp_setup setup = {
        .saved = {.address = 5, .baud = 9600, .has_key = has_key},
        .plain = plain,
        .vendor = {0x11, 0x22, 0x33},
        .model = 0x44,
        .version = 0x55,
        .serial = 0x66778899,
        .firmware = {1, 2, 3},
        .inputs = 3,
        .random = make_random,
        .store = store,
        .context = bench,
    };
    memcpy(setup.saved.key, bench_key, has_key ? 16 : 0);
    return setup;
}

void bench_init(struct bench *bench, bool has_key, bool plain)
{
    memset(bench, 0, sizeof *bench);
    bench->panel.address = 5;
    bench->panel.sequence = -1;
    bench->now_ns = 7 * BENCH_SECOND_NS;
    bench->random = 0xA0;
    const struct iso_osdp_setup setup = bench_setup(bench, has_key, plain);
    assert_int_equal(iso_osdp_peripheral_new(&setup, &bench->device), 0);
}

void bench_done(struct bench *bench)
{
    iso_osdp_peripheral_free(bench->device);
}

void bench_exchange(struct bench *bench, struct panel_reply *reply)
{
    uint8_t frame[ISO_OSDP_FRAME_BYTES];
    const size_t n = iso_osdp_peripheral_receive(bench->device, bench->panel.frame,
                                                 bench->panel.n_frame, bench->now_ns, frame);
    panel_read(&bench->panel, frame, n, reply);
    (void)iso_osdp_peripheral_sent(bench->device);
}

int bench_ask(struct bench *bench, uint8_t command, const void *data, size_t n,
              struct panel_reply *reply)
{
    panel_make(&bench->panel, command, data, n);
    bench_exchange(bench, reply);
    return reply->code;
}

bool bench_secure(struct bench *bench, const uint8_t key[16])
{
    static const uint8_t rnd_a[8] = {0xB0, 0xB1, 0xB2, 0xB3, 0xB4, 0xB5, 0xB6, 0xB7};
    struct panel_reply reply;
    uint8_t proof[16];
    const int which = memcmp(key, bench_default_key, 16) != 0;
    bench->panel.sequence = -1;
    panel_challenge(&bench->panel, key, rnd_a);
    panel_make_plain(&bench->panel, 0x76, 0x11, which, rnd_a, sizeof rnd_a);
    bench_exchange(bench, &reply);
    if (!panel_answer(&bench->panel, &reply, proof)) {
        return false;
    }
    panel_make_plain(&bench->panel, 0x77, 0x13, which, proof, sizeof proof);
    bench_exchange(bench, &reply);
    return panel_begin(&bench->panel, &reply);
}

struct iso_osdp_status bench_status(const struct bench *bench)
{
    struct iso_osdp_status status;
    iso_osdp_peripheral_status(bench->device, bench->now_ns, &status);
    return status;
}
