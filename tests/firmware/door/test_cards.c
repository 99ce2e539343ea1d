/* The file of card numbers. Its reader is strict. */
#include <errno.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/door/cards.h"
#include "tests/support/scratch.h"

static void finds_the_card_of_each_person(void **state)
{
    const char *path = scratch_path(*state, "cards");
    struct iso_cards *cards = NULL;
    scratch_write_text(path, "# facility number name\n17 4711 anna\n\n17 0 Zoë van der Berg\n");
    assert_int_equal(iso_cards_load(path, &cards, NULL), 0);
    const struct iso_card *card = iso_cards_find(cards, "anna");
    assert_non_null(card);
    assert_int_equal(card->number.facility, 17);
    assert_int_equal(card->number.number, 4711);
    assert_string_equal(card->person, "anna");
    card = iso_cards_find(cards, "Zoë van der Berg");
    assert_non_null(card);
    assert_int_equal(card->number.number, 0);
    assert_ptr_equal(iso_cards_find(cards, "zoë VAN DER berg"),
                     card); /* both spellings are one name */
    assert_null(iso_cards_find(cards, "bob"));
    assert_null(iso_cards_find(cards, ""));
    iso_cards_free(cards);
    iso_cards_free(NULL);
}

/* A gallery of an earlier version may have both Ada and ada as people. */
static void two_spellings_are_two_cards(void **state)
{
    const char *path = scratch_path(*state, "cards");
    struct iso_cards *cards = NULL;
    scratch_write_text(path, "17 1 Ada\n17 2 ada\n");
    assert_int_equal(iso_cards_load(path, &cards, NULL), 0);
    assert_int_equal(iso_cards_find(cards, "Ada")->number.number, 1);
    assert_int_equal(iso_cards_find(cards, "ada")->number.number, 2);
    assert_null(iso_cards_find(cards, "ADA")); /* the name may mean either of them */
    iso_cards_free(cards);
}

static void refuses_wrong_lines(void **state)
{
    static const char *const bad[][2] = {
        {"17 4711\n", "cards:1: not `FACILITY NUMBER NAME`"},
        {"17\n", "cards:1: not `FACILITY NUMBER NAME`"},
        {"17 x anna\n", "cards:1: facility and number are 0 to 65535"},
        {"-1 3 anna\n", "cards:1: facility and number are 0 to 65535"},
        {"1 65536 anna\n", "cards:1: facility and number are 0 to 65535"},
        {"1 3  anna\n", "cards:1: "},
        {"1 3 an\u200bna\n", "cards:1: the name holds an invisible character"},
        {"1 3 anna\n1 4 anna\n", "cards:2: this person has a card already"},
        {"1 3 anna\n1 3 bob\n", "cards:2: somebody has this card already"},
    };
    const char *path = scratch_path(*state, "cards");
    struct iso_fault fault;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct iso_cards *cards = NULL;
        scratch_write_text(path, bad[i][0]);
        assert_int_equal(iso_cards_load(path, &cards, &fault), -EBADMSG);
        if (!strstr(fault.text, bad[i][1])) {
            fail_msg("'%s' lacks '%s'", fault.text, bad[i][1]);
        }
        assert_null(cards);
    }
    struct iso_cards *cards = NULL;
    assert_int_equal(iso_cards_load("/nonexistent/cards", &cards, &fault), -ENOENT);
    assert_string_equal(fault.text, "/nonexistent/cards: No such file or directory");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(finds_the_card_of_each_person, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(two_spellings_are_two_cards, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(refuses_wrong_lines, scratch_setup, scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
