/* The secure channel: the values of the standard, and a panel that has the right key, the wrong key
 * or none. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/door/osdp/osdp_secure.h"
#include "tests/drivers/door/osdp/osdp_bench.h"

/* SIA OSDP 2.2, Annex E: the default key, RND.A and RND.B give these keys and cryptograms. */
static const uint8_t rnd_a[8] = {0xB0, 0xB1, 0xB2, 0xB3, 0xB4, 0xB5, 0xB6, 0xB7};
static const uint8_t rnd_b[8] = {0xA0, 0xA1, 0xA2, 0xA3, 0xA4, 0xA5, 0xA6, 0xA7};
static const uint8_t s_mac1[16] = {0x5E, 0x86, 0xC6, 0x76, 0x60, 0x3B, 0xDE, 0xE2,
                                   0xD8, 0xBE, 0xAF, 0xE1, 0x78, 0x63, 0x73, 0x32};
static const uint8_t s_mac2[16] = {0x6F, 0xDA, 0x86, 0xE8, 0x57, 0x77, 0x7E, 0x81,
                                   0x13, 0x20, 0x35, 0x75, 0x82, 0x39, 0x17, 0x2E};
static const uint8_t s_enc[16] = {0xBF, 0x8D, 0xC2, 0xA8, 0x32, 0x9A, 0xCB, 0x8C,
                                  0x67, 0xC6, 0xD0, 0xCD, 0x9A, 0x45, 0x16, 0x82};
static const uint8_t server[16] = {0x26, 0xD3, 0x35, 0x6E, 0x07, 0x76, 0x2D, 0x26,
                                   0x28, 0x01, 0xFC, 0x8E, 0x66, 0x65, 0xA8, 0x91};
static const uint8_t client[16] = {0xFD, 0xE5, 0xD2, 0xF4, 0x28, 0xEC, 0x16, 0x31,
                                   0x24, 0x71, 0xEA, 0x3C, 0x02, 0xBD, 0x77, 0x96};
static const uint8_t first_rmac[16] = {0xB2, 0xA3, 0x00, 0x57, 0xEB, 0x98, 0xBA, 0x22,
                                       0x29, 0xEC, 0x1F, 0x87, 0x56, 0x62, 0xB5, 0x24};

static void test_values_of_the_standard(void **state)
{
    (void)state;
    struct iso_osdp_secure secure = {0};
    uint8_t cryptogram[16], rmac_i[16];
    iso_osdp_secure_challenge(&secure, iso_osdp_default_key, rnd_a, rnd_b, cryptogram);
    assert_memory_equal(secure.s_enc, s_enc, 16);
    assert_memory_equal(secure.s_mac1, s_mac1, 16);
    assert_memory_equal(secure.s_mac2, s_mac2, 16);
    assert_memory_equal(cryptogram, client, 16);
    assert_int_equal(iso_osdp_secure_prove(&secure, server, rmac_i), 0);
    assert_memory_equal(rmac_i, first_rmac, 16);
    assert_int_equal(secure.state, ISO_OSDP_OPEN);
    iso_osdp_secure_close(&secure);
    const struct iso_osdp_secure zero = {0};
    assert_memory_equal(&secure, &zero, sizeof zero);
}

/* The panel of the tests has to agree with the standard, too. */
static void test_panel_keeps_to_the_standard(void **state)
{
    (void)state;
    struct panel panel = {.sequence = -1};
    struct panel_reply ccrypt = {.code = 0x76, .block = 0x12, .n = 32};
    uint8_t proof[16];
    panel_challenge(&panel, bench_default_key, rnd_a);
    memcpy(ccrypt.data + 8, rnd_b, 8);
    memcpy(ccrypt.data + 16, client, 16);
    assert_true(panel_answer(&panel, &ccrypt, proof));
    assert_memory_equal(proof, server, 16);
    assert_memory_equal(panel.r_mac, first_rmac, 16);
}

static void test_every_wrong_proof_closes(void **state)
{
    (void)state;
    for (int bit = 0; bit < 128; bit++) {
        struct iso_osdp_secure secure = {0};
        uint8_t cryptogram[16], proof[16], rmac_i[16] = {7};
        iso_osdp_secure_challenge(&secure, iso_osdp_default_key, rnd_a, rnd_b, cryptogram);
        memcpy(proof, server, 16);
        proof[bit / 8] ^= (uint8_t)(1 << bit % 8);
        assert_int_equal(iso_osdp_secure_prove(&secure, proof, rmac_i), -EACCES);
        assert_int_equal(rmac_i[0], 7);
        assert_int_equal(secure.state, ISO_OSDP_CLOSED);
        assert_int_equal(iso_osdp_secure_prove(&secure, server, rmac_i), -EACCES);
    }
}

/* ---- with a device ---- */

static void test_right_key_opens(void **state)
{
    (void)state;
    struct bench bench;
    struct panel_reply reply;
    bench_init(&bench, true, false);
    assert_true(bench_secure(&bench, bench_key));
    assert_true(bench_status(&bench).secure);
    assert_int_equal(bench_ask(&bench, 0x60, NULL, 0, &reply), 0x40);
    assert_int_equal(reply.block, 0x16);
    assert_int_equal(bench_ask(&bench, 0x61, "", 1, &reply), 0x45);
    assert_int_equal(reply.block, 0x18);
    assert_int_equal(reply.n, 12);
    bench_done(&bench);
}

static void test_check_sum_works_in_the_channel(void **state)
{
    (void)state;
    struct bench bench;
    struct panel_reply reply;
    bench_init(&bench, true, false);
    bench.panel.checksum = true;
    assert_true(bench_secure(&bench, bench_key));
    for (int i = 0; i < 10; i++) {
        assert_int_equal(bench_ask(&bench, 0x62, "", 1, &reply), 0x46);
    }
    bench_done(&bench);
}

static void test_wrong_key_does_not_open(void **state)
{
    (void)state;
    struct bench bench;
    struct panel_reply reply;
    uint8_t wrong[16], proof[16];
    bench_init(&bench, true, false);
    memcpy(wrong, bench_key, 16);
    wrong[15] ^= 1;
    assert_false(bench_secure(&bench, wrong));
    /* The panel goes on although it knows that the key is wrong. */
    panel_challenge(&bench.panel, wrong, rnd_a);
    panel_make_plain(&bench.panel, 0x76, 0x11, 1, rnd_a, 8);
    bench_exchange(&bench, &reply);
    assert_int_equal(reply.code, 0x76);
    assert_false(panel_answer(&bench.panel, &reply, proof));
    panel_make_plain(&bench.panel, 0x77, 0x13, 1, proof, 16);
    bench_exchange(&bench, &reply);
    assert_int_equal(reply.code, 0x78);
    assert_int_equal(reply.block_data, 0xFF);
    assert_int_equal(reply.n, 0);
    assert_false(bench_status(&bench).secure);
    assert_true(bench_status(&bench).refused >= 1);
    bench_done(&bench);
}

static void test_default_key_needs_the_install_mode(void **state)
{
    (void)state;
    struct bench bench;
    for (int has_key = 0; has_key < 2; has_key++) {
        bench_init(&bench, has_key, false);
        assert_false(bench_secure(&bench, bench_default_key));
        bench.now_ns += ISO_OSDP_REPEAT_NS;
        iso_osdp_peripheral_install(bench.device, bench.now_ns);
        assert_true(bench_status(&bench).install);
        assert_true(bench_secure(&bench, bench_default_key));
        assert_true(bench_status(&bench).default_key);
        assert_false(bench_status(&bench).secure);
        /* It ends after two minutes, and with it the channel. */
        bench.now_ns += ISO_OSDP_INSTALL_NS - 1;
        iso_osdp_peripheral_tick(bench.device, bench.now_ns);
        assert_true(bench_status(&bench).install);
        assert_true(bench_secure(&bench, bench_default_key));
        bench.now_ns += 1;
        iso_osdp_peripheral_tick(bench.device, bench.now_ns);
        assert_false(bench_status(&bench).install);
        assert_false(bench_status(&bench).default_key);
        assert_false(bench_secure(&bench, bench_default_key));
        bench_done(&bench);
    }
}

static void test_key_is_set_and_used(void **state)
{
    (void)state;
    struct bench bench;
    struct panel_reply reply;
    uint8_t keyset[18] = {1, 16};
    bench_init(&bench, false, false);
    assert_false(bench_secure(&bench, bench_key));
    iso_osdp_peripheral_install(bench.device, bench.now_ns);
    assert_true(bench_secure(&bench, bench_default_key));
    memcpy(keyset + 2, bench_key, 16);
    /* What cannot be stored is refused. */
    bench.store_error = -EIO;
    assert_int_equal(bench_ask(&bench, 0x75, keyset, 18, &reply), 0x41);
    assert_int_equal(reply.data[0], 9);
    bench.store_error = 0;
    assert_int_equal(bench_ask(&bench, 0x75, keyset, 18, &reply), 0x40);
    assert_int_equal(bench.stores, 1);
    assert_true(bench.saved.has_key);
    assert_memory_equal(bench.saved.key, bench_key, 16);
    assert_int_equal(bench.saved.address, 5);
    assert_false(bench_status(&bench).install);
    /* The install mode is over: no second key through the default key. */
    assert_int_equal(bench_ask(&bench, 0x75, keyset, 18, &reply), 0x41);
    assert_int_equal(reply.data[0], 6);
    assert_true(bench_secure(&bench, bench_key));
    assert_false(bench_secure(&bench, bench_default_key));
    bench_done(&bench);
}

static void test_wrong_keys_are_refused(void **state)
{
    (void)state;
    struct bench bench;
    struct panel_reply reply;
    uint8_t keyset[19] = {1, 16};
    bench_init(&bench, true, true);
    memcpy(keyset + 2, bench_key, 16);
    /* In plain, although plain frames are permitted. */
    assert_int_equal(bench_ask(&bench, 0x75, keyset, 18, &reply), 0x41);
    assert_int_equal(reply.data[0], 6);
    assert_true(bench_secure(&bench, bench_key));
    assert_int_equal(bench_ask(&bench, 0x75, keyset, 19, &reply), 0x41);
    assert_int_equal(reply.data[0], 2);
    keyset[0] = 2; /* no such kind of key */
    assert_int_equal(bench_ask(&bench, 0x75, keyset, 18, &reply), 0x41);
    assert_int_equal(reply.data[0], 9);
    keyset[0] = 1;
    memcpy(keyset + 2, bench_default_key, 16);
    assert_int_equal(bench_ask(&bench, 0x75, keyset, 18, &reply), 0x41);
    assert_int_equal(reply.data[0], 9);
    assert_int_equal(bench.stores, 0);
    assert_int_equal(bench_status(&bench).keys_set, 0);
    bench_done(&bench);
}

/* ---- somebody else on the wire ---- */

static void test_changed_frames_have_no_effect(void **state)
{
    (void)state;
    struct bench bench;
    struct panel_reply reply;
    const uint8_t text[] = {0, 1, 0, 1, 1, 2, 'o', 'k'};
    bench_init(&bench, true, false);
    assert_true(bench_secure(&bench, bench_key));
    panel_make(&bench.panel, 0x6B, text, sizeof text);
    /* Every bit of block, code, data and MAC is changed, and the CRC made right again. */
    for (size_t bit = 8 * 7; bit < 8 * (bench.panel.n_frame - 2); bit++) {
        uint8_t frame[64], answer[ISO_OSDP_FRAME_BYTES];
        const size_t n = bench.panel.n_frame;
        memcpy(frame, bench.panel.frame, n);
        frame[bit / 8] ^= (uint8_t)(1 << bit % 8);
        panel_put_crc(frame, n - 2);
        assert_int_equal(iso_osdp_peripheral_receive(bench.device, frame, n, bench.now_ns, answer),
                         0);
    }
    assert_string_equal(bench_status(&bench).shown.text[0], "");
    /* The true frame is done as if nothing had been. */
    bench_exchange(&bench, &reply);
    assert_int_equal(reply.code, 0x40);
    assert_string_equal(bench_status(&bench).shown.text[0], "ok");
    bench_done(&bench);
}

static void test_old_frames_have_no_effect(void **state)
{
    (void)state;
    struct bench bench;
    struct panel_reply reply;
    struct panel old;
    const uint8_t text[] = {0, 1, 0, 1, 1, 2, 'o', 'k'}, empty[] = {0, 1, 0, 1, 1, 0};
    bench_init(&bench, true, false);
    assert_true(bench_secure(&bench, bench_key));
    assert_int_equal(bench_ask(&bench, 0x6B, text, sizeof text, &reply), 0x40);
    old = bench.panel;
    assert_int_equal(bench_ask(&bench, 0x6B, empty, sizeof empty, &reply), 0x40);
    assert_int_equal(bench_ask(&bench, 0x60, NULL, 0, &reply), 0x40);
    /* Now the old frame has the next sequence number. */
    uint8_t answer[ISO_OSDP_FRAME_BYTES];
    assert_int_equal(old.sequence, bench.panel.sequence % 3 + 1);
    assert_int_equal(
        iso_osdp_peripheral_receive(bench.device, old.frame, old.n_frame, bench.now_ns, answer), 0);
    assert_string_equal(bench_status(&bench).shown.text[0], "");
    assert_int_equal(bench_ask(&bench, 0x60, NULL, 0, &reply), 0x40);
    bench_done(&bench);
}

static void test_plain_frames_do_not_enter_the_channel(void **state)
{
    (void)state;
    struct bench bench;
    struct panel_reply reply;
    bench_init(&bench, true, true);
    assert_true(bench_secure(&bench, bench_key));
    struct panel other = bench.panel;
    other.secure = false;
    const uint8_t text[] = {0, 1, 0, 1, 1, 2, 'n', 'o'};
    uint8_t answer[ISO_OSDP_FRAME_BYTES];
    panel_make(&other, 0x6B, text, sizeof text);
    const size_t n = iso_osdp_peripheral_receive(bench.device, other.frame, other.n_frame,
                                                 bench.now_ns, answer);
    panel_read(&other, answer, n, &reply);
    assert_int_equal(reply.code, 0x41);
    assert_int_equal(reply.data[0], 6);
    assert_string_equal(bench_status(&bench).shown.text[0], "");
    assert_int_equal(bench_ask(&bench, 0x60, NULL, 0, &reply), 0x40);
    assert_true(bench_status(&bench).secure);
    bench_done(&bench);
}

static void test_padding_and_blocks_are_checked(void **state)
{
    (void)state;
    struct bench bench;
    struct panel_reply reply;
    bench_init(&bench, true, false);
    /* A frame with a MAC outside of a channel; CHLNG without a block, with too many bytes, and
     * without random numbers. */
    bench.panel.sequence = 0;
    panel_make_plain(&bench.panel, 0x61, 0, -1, "", 1);
    bench.panel.sequence = -1;
    assert_int_equal(bench_ask(&bench, 0x61, "", 1, &reply), 0x45);
    bench.panel.secure = true;
    panel_make(&bench.panel, 0x60, NULL, 0);
    bench_exchange(&bench, &reply);
    assert_int_equal(reply.code, 0x41);
    assert_int_equal(reply.data[0], 5);
    bench.panel.secure = false;
    bench.panel.sequence = 0;
    assert_int_equal(bench_ask(&bench, 0x76, rnd_a, 8, &reply), 0x41);
    assert_int_equal(reply.data[0], 5);
    panel_make_plain(&bench.panel, 0x76, 0x11, 1, "123456789", 9);
    bench_exchange(&bench, &reply);
    assert_int_equal(reply.data[0], 2);
    bench.random_error = -EIO;
    panel_make_plain(&bench.panel, 0x76, 0x11, 1, rnd_a, 8);
    bench_exchange(&bench, &reply);
    assert_int_equal(reply.data[0], 9);
    /* SCRYPT without CHLNG. */
    panel_make_plain(&bench.panel, 0x77, 0x13, 1, server, 16);
    bench_exchange(&bench, &reply);
    assert_int_equal(reply.code, 0x41);
    assert_int_equal(reply.data[0], 5);
    bench_done(&bench);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_values_of_the_standard),
        cmocka_unit_test(test_panel_keeps_to_the_standard),
        cmocka_unit_test(test_every_wrong_proof_closes),
        cmocka_unit_test(test_right_key_opens),
        cmocka_unit_test(test_check_sum_works_in_the_channel),
        cmocka_unit_test(test_wrong_key_does_not_open),
        cmocka_unit_test(test_default_key_needs_the_install_mode),
        cmocka_unit_test(test_key_is_set_and_used),
        cmocka_unit_test(test_wrong_keys_are_refused),
        cmocka_unit_test(test_changed_frames_have_no_effect),
        cmocka_unit_test(test_old_frames_have_no_effect),
        cmocka_unit_test(test_plain_frames_do_not_enter_the_channel),
        cmocka_unit_test(test_padding_and_blocks_are_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
