// Who may ask for what: every request of openapi.json without a login, with too small a role, and from another origin; and sessions that
// have ended.
import { expect, expectEqual, need, step } from './check.mjs';
import { operations } from './api.mjs';

const RANKS = ['none', 'observer', 'enroller', 'administrator'];
const bodyOf = (operation) => (operation.body ? {} : undefined);

// Accounts of every role, made by the administrator of the run.
export async function makeAccounts(run) {
  await need('an administrator makes an account of each role', async () => {
    for (const role of RANKS.slice(1)) {
      const answer = await run.admin.ask('POST', '/accounts', { name: `role-${role}`, password: run.password, role });
      expect([201, 409].includes(answer.status), `POST /accounts of the role ${role}: 201 was expected, and ${answer.status} ${answer.code} came`);
    }
    const answer = await run.admin.ask('GET', '/accounts');
    const roles = answer.body.accounts.map((account) => account.role);
    for (const role of RANKS.slice(1)) {
      expect(roles.includes(role), `GET /accounts was expected to list an account of the role ${role}: ${JSON.stringify(answer.body)}`);
    }
  });
}

async function withoutLogin(run) {
  const guarded = operations().filter((operation) => operation.least !== 'none');
  expect(guarded.length > 15, `openapi.json was expected to guard more than 15 requests, and guards ${guarded.length}`);
  for (const operation of guarded) {
    const answer = await run.api().ask(operation.method, operation.path, bodyOf(operation));
    expect(answer.status === 401 && answer.code === 'login-required',
      `${operation.method} ${operation.path} without a login: 401 login-required was expected, and ${answer.status} ${answer.code} came`);
    expect(/problem\+json/.test(answer.headers['content-type']), `${operation.path}: an error was expected to be application/problem+json`);
  }
}

async function withTooSmallARole(run) {
  let asked = 0;
  for (const role of ['observer', 'enroller']) {
    const client = run.api();
    await client.login(`role-${role}`, run.password);
    for (const operation of operations().filter((one) => RANKS.indexOf(one.least) > RANKS.indexOf(role))) {
      const answer = await client.ask(operation.method, operation.path, bodyOf(operation));
      expect(answer.status === 403 && answer.code === 'not-allowed',
        `${operation.method} ${operation.path} as ${role}: 403 not-allowed was expected, and ${answer.status} ${answer.code} came`);
      asked++;
    }
  }
  expect(asked > 15, `more than 15 requests were expected to need a higher role, and ${asked} do`);
}

async function fromElsewhere(run) {
  const foreign = [
    ['the Origin of another host', { origin: 'https://evil.example' }],
    ['the Origin of another port', { origin: 'https://127.0.0.1:1' }],
    ['the Origin null', { origin: 'null' }],
    ['neither Origin nor Sec-Fetch-Site', { origin: undefined }],
    ['Sec-Fetch-Site: cross-site', { 'sec-fetch-site': 'cross-site' }],
    ['Sec-Fetch-Site: same-site', { 'sec-fetch-site': 'same-site' }],
  ];
  for (const operation of operations().filter((one) => one.method !== 'GET' && one.path !== '/session')) {
    for (const [what, headers] of foreign) {
      const answer = await run.admin.ask(operation.method, operation.path, bodyOf(operation), headers);
      expect(answer.status === 403 && answer.code === 'other-origin',
        `${operation.method} ${operation.path} with ${what}: 403 other-origin was expected, and ${answer.status} ${answer.code} came`);
    }
  }
  const read = await run.admin.ask('GET', '/people', undefined, { 'sec-fetch-site': 'cross-site' });
  expectEqual(read.status, 403, 'GET /people with Sec-Fetch-Site: cross-site');
}

async function endedSessions(run) {
  const client = run.api();
  await client.login('role-enroller', run.password);
  const first = client.cookie;
  expectEqual((await client.ask('GET', '/people')).status, 200, 'GET /people with a session of the role enroller');
  expectEqual((await client.ask('DELETE', '/session')).status, 204, 'the logout');
  expectEqual((await client.ask('GET', '/people', undefined, { cookie: first })).status, 401, 'GET /people with the cookie of before the logout');

  await client.login('role-enroller', run.password);
  const stream = await run.streamEnd(client, '/events');
  const changed = await run.admin.ask('PATCH', '/accounts/role-enroller', { role: 'observer' });
  expectEqual(changed.status, 200, 'PATCH /accounts/role-enroller');
  expectEqual((await client.ask('GET', '/people')).status, 401, 'GET /people with a session of before the change of the role');
  await stream('the stream /events ends with its session');
  await client.login('role-enroller', run.password);
  expectEqual((await client.ask('GET', '/people')).status, 403, 'GET /people as an observer after the change of the role');
  await run.admin.ask('PATCH', '/accounts/role-enroller', { role: 'enroller' });
}

async function strangeBodies(run) {
  const cases = [
    ['a body that is no JSON', '{', {}, 400, 'invalid-json'],
    ['an array', '[]', {}, 400, 'invalid-json'],
    ['a form', 'a=b', { 'content-type': 'application/x-www-form-urlencoded' }, 415, 'no-json'],
    ['a text', '{"on":true}', { 'content-type': 'text/plain' }, 415, 'no-json'],
    ['a body of 65 KiB', JSON.stringify({ on: true, rest: 'x'.repeat(65 << 10) }), {}, 413, 'too-large'],
  ];
  for (const [what, body, headers, status, code] of cases) {
    const answer = await run.admin.ask('PUT', '/lockdown', body, headers);
    expect(answer.status === status && answer.code === code, `${what}: ${status} ${code} was expected, and ${answer.status} ${answer.code} came`);
  }
  expectEqual((await run.admin.ask('GET', '/nothing')).status, 404, 'GET /nothing');
  expectEqual((await run.admin.ask('POST', '/status', {})).status, 405, 'POST /status');
  const state = await run.admin.ask('GET', '/status');
  expectEqual(state.body.status.lockdown, false, 'the lockdown after these requests');
}

async function headersOfPages(run) {
  const answer = await run.page('/');
  const policy = answer.headers['content-security-policy'] ?? '';
  expect(/default-src '(none|self)'/.test(policy) && !/unsafe|\*|https?:/.test(policy),
    `a content security policy without unsafe-inline and foreign sources was expected: "${policy}"`);
  expectEqual(answer.headers['x-content-type-options'], 'nosniff', 'X-Content-Type-Options');
  const cookie = (await run.api().login('role-observer', run.password)).headers['set-cookie'][0];
  for (const word of ['__Host-isotherm=', 'HttpOnly', 'Secure', 'SameSite=Strict', 'Path=/']) {
    expect(cookie.includes(word), `the cookie was expected to have ${word}: ${cookie.replace(/=[^;]*/, '=...')}`);
  }
  for (const path of ['/../../etc/passwd', '/%2e%2e/%2e%2e/etc/passwd', '/README.md']) {
    expectEqual((await run.page(path)).status, 404, `GET ${path}`);
  }
}

export async function access(run) {
  await step('every request without a login is refused (401)', () => withoutLogin(run));
  await makeAccounts(run);
  await step('every request with too small a role is refused (403)', () => withTooSmallARole(run));
  await step('every change from another origin is refused (403)', () => fromElsewhere(run));
  await step('sessions end with the logout and with a change of the role', () => endedSessions(run));
  await step('bodies that are no JSON objects are refused and change nothing', () => strangeBodies(run));
  await step('pages have a strict policy, and the cookie is only for this server', () => headersOfPages(run));
}
