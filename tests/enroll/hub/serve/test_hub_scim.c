/* SCIM over HTTPS, before the running hub: what Entra ID and Okta send by their documentation,
 * and what is refused. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/enroll/hub/serve/scim_rig.h"

/* ---- tokens ---- */

static void nobody_asks_without_a_token(void **state)
{
    char right[HUB_SCIM_TOKEN_SIZE];
    struct iso_fault fault = {.text = ""};
    (void)state;

    served_door_begin();
    (void)strcpy(right, scim_token);
    scim_do("GET", "Users", NULL, 200);
    scim_token[0] = '\0';
    scim_do("GET", "Users", NULL, 401);
    assert_true(scim_has(scim_headers, "WWW-Authenticate: Bearer"));
    (void)strcpy(scim_token, "isotherm-scim-wrong");
    for (int i = 0; i < 3; i++) {
        scim_do("GET", "ServiceProviderConfig", NULL, 401);
    }
    scim_do("GET", "Users", NULL, 429);
    assert_true(scim_has(scim_headers, "Retry-After"));
    (void)strcpy(scim_token, right);
    scim_do("GET", "Users", NULL, 200); /* failures of others do not hold it up */
    assert_int_equal(scim_number("SELECT count(*) FROM scim_token WHERE used_s > 0"), 1);
    assert_int_equal(scim_number("SELECT count(*) FROM scim_token WHERE "
                                 "position('isotherm-scim'::bytea in digest) > 0"),
                     0);
    served_ok(hub_scim_token_revoke(&rig.store, "entra", &fault), &fault);
    scim_do("GET", "Users", NULL, 401);
    assert_int_equal(hub_scim_token_revoke(&rig.store, "entra", &fault), -ENOENT);
    assert_int_equal(hub_scim_token_make(&rig.store, "No Name", right, &fault), -EINVAL);
}

static void it_says_what_it_can(void **state)
{
    (void)state;

    served_door_begin();
    assert_string_equal(scim_text("ServiceProviderConfig", "patch/supported"), "true");
    assert_true(scim_has(scim_headers, "application/scim+json"));
    assert_string_equal(scim_text("ResourceTypes", "totalResults"), "2");
    assert_string_equal(scim_text("ResourceTypes/User", "endpoint"), "/Users");
    assert_string_equal(scim_text("Schemas", "totalResults"), "3");
    assert_string_equal(scim_text("Schemas/" SCIM_CORE_USER, "name"), "User");
    scim_do("GET", "Schemas/urn:nothing", NULL, 404);
    scim_do("POST", "Schemas", "{}", 405);
    scim_do("GET", "Bulk", NULL, 404);
    scim_do("POST", "Users/0190b3f2-0000-4000-8000-000000000000", "{}", 405);
}

/* ---- what providers send ---- */

static void entra_makes_changes_and_disables_a_user(void **state)
{
    char path[256];
    (void)state;

    served_door_begin();
    assert_string_equal(
        scim_text("Users?filter=userName%20eq%20%22Test_User_dfeef4c5%22", "totalResults"), "0");
    const char *user = scim_make(
        "Users",
        "{'schemas':['" SCIM_CORE_USER
        "','urn:ietf:params:scim:schemas:extension:enterprise:2.0:User'],'externalId':"
        "'0a21f0f2-8d2a-4f8e-bf98-7363c4aed4ef','userName':'Test_User_ab6490ee','active':true,"
        "'emails':[{'primary':true,'type':'work','value':'Test_User@testuser.com'}],"
        "'meta':{'resourceType':'User'},'name':{'formatted':'givenName familyName','familyName':"
        "'familyName','givenName':'givenName'},'roles':[]}");
    assert_string_equal(scim_text(user, "active"), "true");
    assert_string_equal(scim_text(user, "emails"), ""); /* it is not kept */
    assert_string_equal(scim_text("Users?filter=userName%20eq%20%22test_user_AB6490EE%22",
                                  "Resources/0/externalId"),
                        "0a21f0f2-8d2a-4f8e-bf98-7363c4aed4ef");
    scim_do("PATCH", user,
            SCIM_PATCH
            "[{'op':'Replace','path':'emails[type eq \\'work\\'].value','value':"
            "'updatedEmail@microsoft.com'},{'op':'Replace','path':'name.familyName','value':"
            "'updatedFamilyName'}]}",
            200);
    assert_string_equal(scim_text(user, "name/familyName"), "updatedFamilyName");
    scim_do("PATCH", user,
            SCIM_PATCH "[{'op':'Replace','path':'userName','value':'5b50642d-79fc-4410-9e90'}]}",
            200);
    scim_do("PATCH", user,
            SCIM_PATCH
            "[{'op':'Add','value':{'displayName':'Grace','name.givenName':'G',"
            "'urn:ietf:params:scim:schemas:extension:enterprise:2.0:User:department':'d'}}]}",
            200);
    assert_string_equal(scim_text(user, "displayName"), "Grace");
    scim_do("PATCH", user, SCIM_PATCH "[{'op':'Replace','path':'active','value':'False'}]}", 200);
    assert_string_equal(scim_text(user, "active"), "false");
    scim_do("PATCH", user, SCIM_PATCH "[{'op':'Replace','path':'active','value':'True'}]}", 200);
    (void)snprintf(path, sizeof path, "Users?filter=externalId+eq+%%22%s%%22&attributes=id",
                   "0a21f0f2-8d2a-4f8e-bf98-7363c4aed4ef");
    assert_string_equal(scim_text(path, "totalResults"), "1");
    scim_do("DELETE", user, NULL, 204);
    scim_do("GET", user, NULL, 404);
    scim_do("DELETE", user, NULL, 404);
}

static void entra_fills_and_empties_a_group(void **state)
{
    char body[512];
    (void)state;

    served_door_begin();
    const char *user = scim_ada(), *id = user + strlen("Users/");
    const char *group = scim_make(
        "Groups", "{'schemas':['urn:ietf:params:scim:schemas:core:2.0:Group','http://"
                  "schemas.microsoft.com/2006/11/ResourceManagement/ADSCIM/2.0/Group'],"
                  "'externalId':'8aa1a0c0-c4c3-4bc0-b4a5-2ef676900159','displayName':'Staff',"
                  "'meta':{'resourceType':'Group'}}");
    assert_string_equal(scim_text("Groups?excludedAttributes=members&filter=displayName%20eq%20"
                                  "%22staff%22",
                                  "Resources/0/displayName"),
                        "Staff");
    scim_add_member(group, user);
    assert_string_equal(scim_text(group, "members/0/value"), id);
    (void)snprintf(body, sizeof body, "%s?excludedAttributes=members", group);
    assert_string_equal(scim_text(body, "members/0/value"), "");
    assert_string_equal(scim_text(user, "groups/0/display"), "Staff");
    (void)snprintf(body, sizeof body,
                   SCIM_PATCH
                   "[{'op':'Remove','path':'members','value':[{'$ref':null,'value':'%s'}]}]}",
                   "0190b3f2-0000-4000-8000-000000000000");
    scim_do("PATCH", group, body, 200); /* somebody else */
    assert_string_equal(scim_text(group, "members/0/value"), id);
    (void)snprintf(
        body, sizeof body,
        SCIM_PATCH "[{'op':'Remove','path':'members','value':[{'$ref':null,'value':'%s'}]}]}", id);
    scim_do("PATCH", group, body, 200);
    assert_string_equal(scim_text(group, "members/0/value"), "");
    scim_do("PATCH", group,
            SCIM_PATCH "[{'op':'Replace','path':'displayName','value':'1879db59-3bdf-4490-ad68'}]}",
            200);
    (void)snprintf(
        body, sizeof body,
        SCIM_PATCH "[{'op':'Add','path':'members','value':[{'value':'%s','type':'Group'}]}]}", id);
    scim_do("PATCH", group, body, 400);
    scim_do("PATCH", group,
            SCIM_PATCH "[{'op':'Add','path':'members','value':[{'value':"
                       "'0190b3f2-0000-4000-8000-000000000000'}]}]}",
            400);
    scim_do("DELETE", group, NULL, 204);
    scim_do("GET", group, NULL, 404);
}

static void okta_pushes_users_and_groups(void **state)
{
    char body[512];
    (void)state;

    served_door_begin();
    scim_do("GET", "Users?filter=userName%20eq%20%22a%40example.org%22&startIndex=1&count=100",
            NULL, 200);
    const char *user = scim_make(
        "Users",
        "{'schemas':['" SCIM_CORE_USER
        "'],'userName':'test.user@okta.local','name':{'givenName':'Test',"
        "'familyName':'User'},'emails':[{'primary':true,'value':'test.user@okta.local','type':"
        "'work'}],'displayName':'Test User','locale':'en-US','externalId':'00ujl29u0le5T6Aj10h7',"
        "'groups':[],'password':'1mz050nq','active':true}");
    assert_int_equal(
        scim_number("SELECT count(*) FROM scim_user u WHERE u::text LIKE '%1mz050nq%'"), 0);
    (void)snprintf(body, sizeof body,
                   "{'schemas':['" SCIM_CORE_USER "'],'id':'%s','userName':'test.user@okta.local',"
                   "'name':{'givenName':'Another','middleName':'Excited','familyName':'User'},"
                   "'emails':[{'primary':true,'value':'test.user@okta.local','type':'work'}],"
                   "'active':true,'groups':[],'meta':{'resourceType':'User'}}",
                   user + strlen("Users/"));
    scim_do("PUT", user, body, 200);
    assert_string_equal(scim_text(user, "name/givenName"), "Another");
    assert_string_equal(scim_text(user, "externalId"), ""); /* replaced as a whole */
    const char *group = scim_make("Groups", "{'schemas':['urn:ietf:params:scim:schemas:core:2.0:"
                                            "Group'],'displayName':'Test SCIMv2','members':[]}");
    (void)snprintf(body, sizeof body,
                   SCIM_PATCH
                   "[{'op':'replace','value':{'id':'%s','displayName':'Test SCIMv3'}},"
                   "{'op':'add','path':'members','value':[{'value':'%s','display':'t'}]}]}",
                   group + strlen("Groups/"), user + strlen("Users/"));
    scim_do("PATCH", group, body, 200);
    assert_string_equal(scim_text(group, "displayName"), "Test SCIMv3");
    assert_string_equal(scim_text(group, "members/0/display"), "test.user@okta.local");
    (void)snprintf(body, sizeof body,
                   SCIM_PATCH "[{'op':'remove','path':'members[value eq \\'%s\\']'}]}",
                   user + strlen("Users/"));
    scim_do("PATCH", group, body, 200);
    assert_string_equal(scim_text(group, "members/0/value"), "");
    scim_do("PATCH", user, SCIM_PATCH "[{'op':'replace','value':{'active':false}}]}", 200);
    assert_string_equal(scim_text(user, "active"), "false");
    /* A PUT that does not say so lets nobody in again. */
    scim_do("PUT", user, "{'userName':'test.user@okta.local'}", 200);
    assert_string_equal(scim_text(user, "active"), "false");
}

/* ---- pages, versions, faults ---- */

static void lists_have_pages(void **state)
{
    char user[64];
    (void)state;

    served_door_begin();
    for (int i = 0; i < 5; i++) {
        (void)snprintf(user, sizeof user, "{'userName':'u%d'}", i);
        (void)scim_make("Users", user);
    }
    assert_string_equal(scim_text("Users?startIndex=4&count=3", "totalResults"), "5");
    assert_string_equal(scim_text("Users?startIndex=4&count=3", "itemsPerPage"), "2");
    assert_string_equal(scim_text("Users?startIndex=9", "totalResults"), "5");
    assert_string_equal(scim_text("Users?startIndex=9", "itemsPerPage"), "0");
    assert_string_equal(scim_text("Users?startIndex=-3&count=1", "startIndex"), "1");
    assert_string_equal(scim_text("Users?count=0", "itemsPerPage"), "0");
    scim_do("GET", "Users?count=x", NULL, 400);
}

static void a_version_that_was_not_seen_is_not_changed(void **state)
{
    json_t *json = NULL;
    char header[64];
    (void)state;

    served_door_begin();
    const char *user = scim_ada();
    assert_string_equal(scim_text(user, "meta/version"), "W/\"1\"");
    assert_true(scim_has(scim_headers, "ETag: W/\"1\""));
    assert_int_equal(scim_ask("GET", user, NULL, "If-None-Match: W/\"1\"", NULL), 304);
    const char *body = SCIM_PATCH "[{'op':'replace','path':'displayName','value':'Ada'}]}";
    assert_int_equal(scim_ask("PATCH", user, body, "If-Match: W/\"2\"", &json), 412);
    assert_string_equal(json_string_value(json_object_get(json, "status")), "412");
    json_decref(json);
    assert_int_equal(scim_ask("PATCH", user, body, "If-Match: W/\"1\"", NULL), 200);
    assert_int_equal(scim_ask("GET", user, NULL, "If-None-Match: W/\"1\"", NULL), 200);
    (void)snprintf(header, sizeof header, "If-Match: %s", "W/\"1\"");
    assert_int_equal(scim_ask("DELETE", user, NULL, header, NULL), 412);
    scim_do("DELETE", user, NULL, 204);
}

/* Asks and expects an error of this type. */
static void refused(const char *method, const char *path, const char *body, long status,
                    const char *type)
{
    json_t *json = NULL;

    assert_int_equal(scim_ask(method, path, body, NULL, &json), status);
    assert_string_equal(json_string_value(json_array_get(json_object_get(json, "schemas"), 0)),
                        "urn:ietf:params:scim:api:messages:2.0:Error");
    const char *got = json_string_value(json_object_get(json, "scimType"));
    assert_string_equal(got ? got : "", type);
    json_decref(json);
}

static void faults_have_their_types(void **state)
{
    char large[300];
    (void)state;

    served_door_begin();
    const char *user = scim_ada();
    refused("POST", "Users", "{'userName':'ADA@example.org'}", 409, "uniqueness");
    refused("POST", "Users", "{'displayName':'X'}", 400, "invalidValue");
    refused("POST", "Users", "{'userName':'x','active':'maybe'}", 400, "invalidValue");
    refused("POST", "Users", "{'userName':'x','Active':true,'active':false}", 400, "invalidSyntax");
    refused("POST", "Users", "[1]", 400, "invalidSyntax");
    refused("POST", "Users", "{'userName':", 400, "invalidSyntax");
    refused("GET", "Users?filter=userName%20co%20%22a%22", NULL, 400, "invalidFilter");
    refused("GET", "Users?filter=title%20eq%20%22a%22", NULL, 400, "invalidFilter");
    refused("PATCH", user, SCIM_PATCH "[{'op':'replace','path':'na me','value':1}]}", 400,
            "invalidPath");
    refused("PATCH", user, SCIM_PATCH "[{'op':'remove'}]}", 400, "invalidSyntax");
    refused("PATCH", user, SCIM_PATCH "[{'op':'remove','path':'userName'}]}", 400, "invalidValue");
    refused("PATCH", user, "{'Operations':[]}", 400, "invalidSyntax");
    refused("PUT", "Users/0190b3f2-0000-4000-8000-000000000000", "{'userName':'x'}", 404, "");
    (void)memset(large, 'a', sizeof large);
    large[sizeof large - 1] = '\0';
    char body[400];
    (void)snprintf(body, sizeof body, "{'userName':'%s'}", large);
    refused("POST", "Users", body, 400, "invalidValue");
    /* A face that somebody sends goes nowhere. */
    const char *photo = scim_make("Users", "{'userName':'p','photos':[{'value':'cGhvdG8='}]}");
    assert_string_equal(scim_text(photo, "photos"), "");
    assert_int_equal(scim_number("SELECT count(*) FROM scim_user u WHERE u::text LIKE "
                                 "'%cGhvdG8%'"),
                     0);
    assert_int_equal(
        scim_ask("POST", "Users", "{'userName':'x'}", "Content-Type: text/plain", NULL), 415);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        SCIM_TEST(nobody_asks_without_a_token),
        SCIM_TEST(it_says_what_it_can),
        SCIM_TEST(entra_makes_changes_and_disables_a_user),
        SCIM_TEST(entra_fills_and_empties_a_group),
        SCIM_TEST(okta_pushes_users_and_groups),
        SCIM_TEST(lists_have_pages),
        SCIM_TEST(a_version_that_was_not_seen_is_not_changed),
        SCIM_TEST(faults_have_their_types),
    };
    return cmocka_run_group_tests(tests, NULL, hub_rig_end);
}
