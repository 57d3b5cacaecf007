#!/usr/bin/env bash
# The form of what the forge and the registries read: workflows, issue forms, CITATION.cff, by their schemas; and what a stranger could
# do with the workflows, by zizmor. Both come from PyPI into target/forge.
set -euo pipefail
cd "$(dirname "$0")/../.."
environment=target/forge
[ -x $environment/bin/zizmor ] || {
    "${PYTHON:-python3}" -m venv $environment
    $environment/bin/pip install --quiet --disable-pip-version-check check-jsonschema zizmor
}
schema() { "$environment/bin/check-jsonschema" --builtin-schema "vendor.$1" "${@:2}"; }
schema github-workflows .github/workflows/*.yml
schema github-issue-forms .github/ISSUE_TEMPLATE/[!c]*.yml
schema github-issue-config .github/ISSUE_TEMPLATE/config.yml
schema citation-file-format CITATION.cff
$environment/bin/zizmor --offline --quiet --min-severity medium .github/workflows
