/* The sealed field of a message at its edge: a field of no bytes. */
#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/fleet/message/message_rig.h"

/* An empty field is whole. It must not look as if memory were missing. */
static void an_empty_sealed_field_is_opened(void **state)
{
    struct message_rig rig;
    struct iso_fleet_bytes message = {.bytes = NULL}, plain = {.bytes = NULL};
    (void)state;
    message_rig_start(&rig);
    iso_fleet_put_sealed(&message, rig.hub_box.public, NULL, 0);
    assert_int_equal(message.error, 0);
    struct iso_fleet_reader in = {.bytes = message.bytes, .left = message.size};
    assert_int_equal(iso_fleet_take_sealed(&in, &rig.hub_box, &plain), 0);
    assert_non_null(plain.bytes);
    assert_int_equal(plain.size, 0);
    assert_true(iso_fleet_reader_is_done(&in));
    iso_fleet_bytes_free(&plain);
    iso_fleet_bytes_free(&message);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_empty_sealed_field_is_opened),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
