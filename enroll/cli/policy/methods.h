/* The methods of the daemon for the policy and for credentials. */
#ifndef CLI_POLICY_METHODS_H
#define CLI_POLICY_METHODS_H

#define CLI_METHOD_GET_POLICY     "GetPolicy" /* -> s document, t revision */
#define CLI_METHOD_SET_POLICY     "SetPolicy" /* s document, t revision -> t revision, as remarks */
#define CLI_METHOD_CHECK_POLICY   "CheckPolicy"   /* -> as findings */
#define CLI_METHOD_TEST_ACCESS    "TestAccess"    /* s person, s door, x time, as shown -> a{sv} */
#define CLI_METHOD_GET_CREDENTIAL "GetCredential" /* s person -> s json */
#define CLI_METHOD_SET_CREDENTIAL "SetCredential" /* s person, s patch -> s json */

#endif
