//! Names of values of points that are neither coordinates nor joints.

/// The name of the platform's reference point among the axes of a cloud.
pub const TIP: &str = "tip";
/// The name of one over the condition number, the local conditioning index.
pub const INVERSE_CONDITION: &str = "inverse_condition";
/// The name of the share of the orientations that reach a place.
pub const SHARE: &str = "share";
/// The name of the number of the aspect that a pose is in.
pub const ASPECT: &str = "aspect";
/// The name of an unused axis of a cloud, zero at all points: the set has fewer than three axes.
pub const NO_AXIS: &str = "0";

#[cfg(test)]
mod tests {
    use super::*;
    use opm_analysis::Index;
    use opm_core::mechanism::file;

    /// What names a column of a table is no name of a joint. The reader of mechanism files does not know all of these.
    #[test]
    fn joints_are_not_named_like_columns() {
        let text = include_str!("../../opm-core/mechanisms/five-bar.toml");
        let joint = "name = \"S1\"";
        assert!(text.contains(joint) && file::read(text).is_ok());
        let words =
            ["t", "row", "assembly", "reachable", "within_limits", "valid", "mode", "branch"];
        let names =
            words.into_iter().chain(["balance", "condition", INVERSE_CONDITION, SHARE, ASPECT]);
        let names = names.chain(Index::ALL.map(Index::name)).chain(["d.x", "dd.S2", "effort.S2"]);
        for name in names {
            let errors = file::read(&text.replace(joint, &format!("name = {name:?}"))).unwrap_err();
            assert!(errors.to_string().contains("expected another for joints"), "{errors}");
        }
    }
}
