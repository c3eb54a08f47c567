//! Rocks that stand in many places, as object fields: one OBJ file, and a text with a line for each place.

use glam::{DAffine3, DMat3, DQuat, DVec3};

use crate::geometry::{Copies, Mesh, index_u32};

use super::super::frame;
use super::super::simulation::FieldInstance;
use super::ObjectMesh;
use super::surfaces::surfaces;

/// Axes of a place that are farther from right angles than this are a shear, which DART has none of: f32 has them good to 1e-7.
const SHEAR: f64 = 1e-6;

/// A field: what stands in it, in DART's axes, its own origin, and where.
pub(super) struct Field {
    pub(super) surface: ObjectMesh,
    pub(super) places: Vec<FieldInstance>,
}

/// The surface as fields, and what is left of it: all that are no copies, and copies whose place DART cannot have.
pub(super) struct Split {
    pub(super) fields: Vec<Field>,
    /// The rest, in the axes of the whole mesh; `None` if there are no fields.
    pub(super) rest: Option<Mesh>,
    /// Copies that are part of the rest: sheared, or with their origin outside of the scene.
    pub(super) sheared: usize,
    pub(super) outside: usize,
}

/// Splits a mesh; `dart_from_mesh` leads to DART's frame, whose scene has this size, m.
pub(super) fn split(mesh: &Mesh, copies: &[Copies], dart_from_mesh: DAffine3, size_m: [f64; 2]) -> Split {
    let mut split = Split { fields: Vec::new(), rest: None, sheared: 0, outside: 0 };
    let mut is_rest = vec![true; mesh.facets.len()];
    for copies in copies {
        let each = copies.model.facets.len();
        // More materials than a file has groups: as parts of the surface, which then are several files.
        let [surface] = &mut surfaces(copies.model.clone())[..] else { continue };
        let mut places = Vec::new();
        for (i, place) in copies.places.iter().enumerate() {
            let place = dart_from_mesh * *place;
            let is_inside = (0..2).all(|k| (0.0..=size_m[k]).contains(&place.translation[k]));
            match instance(&place) {
                Some(instance) if is_inside => {
                    let first = copies.facets.start + i * each;
                    is_rest[first..first + each].fill(false);
                    places.push(instance);
                }
                Some(_) => split.outside += 1,
                None => split.sheared += 1,
            }
        }
        if !places.is_empty() {
            split.fields.push(Field { surface: std::mem::replace(surface, no_mesh()), places });
        }
    }
    // A scene has a surface, whose place is that of its origin.
    if split.fields.is_empty() || !is_rest.contains(&true) {
        return Split { fields: Vec::new(), ..split };
    }
    let rest: Vec<u32> = (0..index_u32(mesh.facets.len())).filter(|f| is_rest[*f as usize]).collect();
    split.rest = Some(Mesh { face_of_facet: Vec::new(), ..mesh.part(&rest) });
    split
}

fn no_mesh() -> ObjectMesh {
    ObjectMesh { mesh: Mesh::default(), groups: Vec::new() }
}

/// A place as scales along the model's own axes, then turns; `None` if axes that were at right angles no longer are.
fn instance(place: &DAffine3) -> Option<FieldInstance> {
    let columns = [place.matrix3.x_axis, place.matrix3.y_axis, place.matrix3.z_axis];
    let mut scale = DVec3::from_array(columns.map(DVec3::length));
    let [x, y, z] = columns.map(|column| column.normalize_or_zero());
    let skew = x.dot(y).abs().max(y.dot(z).abs()).max(z.dot(x).abs());
    if skew > SHEAR || scale.min_element() <= 0.0 {
        return None;
    }
    // A mirror is a scale below 0.
    let x = if place.matrix3.determinant() < 0.0 {
        scale.x = -scale.x;
        -x
    } else {
        x
    };
    // By a quaternion, so that what is left of the skew is spread over all axes.
    let turn = DMat3::from_quat(DQuat::from_mat3(&DMat3::from_cols(x, y, z)).normalize());
    Some(FieldInstance { model: 0, position_m: place.translation, scale, rotation_deg: frame::object_deg(turn) })
}

/// The text of a field's places, with all digits.
pub(in crate::formats::dart) fn text(places: &[FieldInstance]) -> String {
    let mut text = String::from("complete transformation\n");
    for FieldInstance { model, position_m: p, scale: s, rotation_deg: r } in places {
        let row = [p.x, p.y, p.z, s.x, s.y, s.z, r.x, r.y, r.z].map(|x| x.to_string());
        text += &format!("{model} {}\n", row.join(" "));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_scales_and_turns_or_nothing() {
        // Half a turn about x, a third of one about z, twice, three and four times as large, and mirrored.
        let turn = DMat3::from_rotation_z(1.0) * DMat3::from_rotation_y(2.0) * DMat3::from_rotation_z(-0.7);
        for mirror in [1.0, -1.0] {
            let matrix3 = turn * DMat3::from_diagonal(DVec3::new(2.0 * mirror, 3.0, 4.0));
            let translation = DVec3::new(5.0, 6.0, 7.0);
            let found = instance(&DAffine3 { matrix3, translation }).unwrap();
            assert_eq!(found.position_m, translation);
            assert!((found.scale - DVec3::new(2.0 * mirror, 3.0, 4.0)).length() < 1e-14);
            let back = frame::object_rotation(found.rotation_deg) * DMat3::from_diagonal(found.scale);
            assert!((0..3).all(|i| (back.col(i) - matrix3.col(i)).length() < 1e-14), "{back} {matrix3}");
        }
        let sheared = DMat3::from_cols(DVec3::X, DVec3::new(1e-5, 1.0, 0.0), DVec3::Z);
        assert_eq!(instance(&DAffine3 { matrix3: sheared, translation: DVec3::ZERO }), None);
    }

    #[test]
    fn a_text_has_all_digits() {
        let place = FieldInstance {
            model: 0,
            position_m: DVec3::new(0.1, -2e-7, 1.0 / 3.0),
            scale: DVec3::ONE,
            rotation_deg: DVec3::new(0.0, 30.0, -0.5),
        };
        let expected = "complete transformation\n0 0.1 -0.0000002 0.3333333333333333 1 1 1 0 30 -0.5\n";
        assert_eq!(text(&[place]), expected);
    }
}
