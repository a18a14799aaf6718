from raysvc.access import Scope


def test_each_scope_includes_those_before_it() -> None:
    reach = {scope: {other for other in Scope if scope.includes(other)} for scope in Scope}
    assert reach == {
        Scope.READ: {Scope.READ},
        Scope.RENDER: {Scope.READ, Scope.RENDER},
        Scope.ADMIN: {Scope.READ, Scope.RENDER, Scope.ADMIN},
    }
